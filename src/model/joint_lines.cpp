#include "model/joint_lines.hpp"

#include "core/errors.hpp"
#include "core/fnv1a.hpp"
#include "core/random.hpp"
#include "geometry/polygon.hpp"
#include "model/trace_lines.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace talus {
namespace {

constexpr std::size_t most_pieces = 1'000'000;
constexpr double most_steps = 1e7;  // of the walk from the origin to the rock: more is a slip in the units

// ---- samplers ------------------------------------------------------------------------------------------------------

double draw(const Spread& spread, Random& random) {
    switch (spread.distribution) {
        case Distribution::normal:
            return spread.mean + spread.deviation * random.normal();
        case Distribution::uniform:
            return spread.mean + spread.deviation * std::sqrt(3.0) * (2.0 * random.uniform() - 1.0);
        case Distribution::lognormal: {  // mean and deviation are those of the variable, not of its logarithm
            const double variance = std::log1p(std::pow(spread.deviation / spread.mean, 2));
            return spread.mean * std::exp(std::sqrt(variance) * random.normal() - variance / 2.0);
        }
        case Distribution::exponential:
            return -spread.mean * std::log1p(-random.uniform());
    }
    return spread.mean;
}

bool is_constant(const Spread& spread) {
    return spread.deviation == 0.0 && spread.distribution != Distribution::exponential;
}

double draw_between(const Spread& spread, double low, double high, Random& random) {
    if (is_constant(spread)) return spread.mean;
    double x = draw(spread, random);
    while (!(low <= x && x <= high)) x = draw(spread, random);
    return x;
}

double draw_length(const Spread& spread, Random& random) {
    return draw_between(spread, spread.mean / 5.0, 5.0 * spread.mean, random);
}

double draw_angle(const Spread& spread, Random& random) {
    return draw_between(spread, spread.mean - 3.0 * spread.deviation, spread.mean + 3.0 * spread.deviation, random);
}

// ---- streams -------------------------------------------------------------------------------------------------------

std::uint64_t seed_of(const JointSetSpec& set) { return Random(set.seed ^ fnv1a(set.name)).bits(); }

/// Independent generators for the uses of one joint line: neighbouring seeds are scrambled by one step of the generator.
enum class Use : std::uint64_t { spacing, angle, phase, forward, backward };
Random stream(std::uint64_t seed, int line, Use use) {
    const auto number = static_cast<std::uint64_t>(static_cast<std::int64_t>(line)) * 8 + static_cast<std::uint64_t>(use);
    return Random(Random(seed ^ (number * 0xd1342543de82ef95ull)).bits());
}

// ---- joint sets ----------------------------------------------------------------------------------------------------

/// Unit vector; exact along the axes, so that bedding lies on the edges of a box and not a rounding error beside them.
Vec2 direction(double angle) {
    Vec2 d(std::cos(angle), std::sin(angle));
    for (double& x : d) {
        if (std::abs(x) < 1e-15) x = 0.0;
        if (std::abs(x) > 1.0 - 1e-15) x = std::copysign(1.0, x);
    }
    return d;
}

struct Interval {
    double low, high;
};

/// Part of the line point + t d inside the box, in t (Liang & Barsky 1984).
std::optional<Interval> inside(const Box& box, const Vec2& point, const Vec2& d) {
    Interval t{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    const auto clip = [&](double position, double step, double low, double high) {
        if (step == 0.0) return low <= position && position <= high;
        const double a = (low - position) / step, b = (high - position) / step;
        t = {std::max(t.low, std::min(a, b)), std::min(t.high, std::max(a, b))};
        return t.low < t.high;
    };
    if (!clip(point.x(), d.x(), box.xmin, box.xmax) || !clip(point.y(), d.y(), box.ymin, box.ymax)) return std::nullopt;
    return t;
}

/// How far across the set, right and left of its origin, a line may start and still meet the box.
Interval reach_across(const JointSetSpec& set, const Box& box, const Vec2& across) {
    Interval reach{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    double radius = 0.0;
    for (const Vec2& corner :
         {Vec2(box.xmin, box.ymin), Vec2(box.xmax, box.ymin), Vec2(box.xmax, box.ymax), Vec2(box.xmin, box.ymax)}) {
        const double s = across.dot(corner - set.origin);
        reach = {std::min(reach.low, s), std::max(reach.high, s)};
        radius = std::max(radius, (corner - set.origin).norm());
    }
    if (is_constant(set.angle)) return reach;
    // A line that starts at s and is turned by delta passes the origin at s cos(delta).
    const double far = radius / std::cos(std::min(3.0 * set.angle.deviation, radians(80.0)));
    return {-far, far};
}

class JointSetLines {
public:
    JointSetLines(const JointSetSpec& set, const Box& box, int source)
        : set_(set), box_(box), source_(source), seed_(seed_of(set)), across_(perp(direction(set.angle.mean))) {}

    std::vector<CutLine> run() {
        const Interval reach = reach_across(set_, box_, across_);
        walk(+1, reach.high);
        walk(-1, -reach.low);
        return std::move(lines_);
    }

private:
    /// Lines 0, 1, 2, ... or -1, -2, ...; distances are counted outwards.
    void walk(int sign, double reach) {
        double distance = 0.0;
        for (int k = 0; distance <= reach; ++k) {
            if (k > 0 || sign > 0) add_line(sign * k, sign * distance);
            Random random = stream(seed_, sign > 0 ? k : -k - 1, Use::spacing);
            if (is_constant(set_.spacing))
                distance = (k + 1) * set_.spacing.mean;  // no sum: line k lies where expected
            else
                distance += draw_length(set_.spacing, random);
        }
    }

    void add_line(int k, double distance) {
        Random random = stream(seed_, k, Use::angle);
        const Vec2 along = is_constant(set_.angle) ? Vec2(-perp(across_)) : direction(draw_angle(set_.angle, random));
        const Vec2 start = set_.origin + distance * across_;
        const std::optional<Interval> t = inside(box_, start, along);
        if (!t) return;
        if (set_.persistence >= 1.0) return add_piece(start, along, *t);
        add_pieces(k, start, along, *t);
    }

    /// Cells of a piece and a gap, the first one around the start of the line, the others outwards from it.
    void add_pieces(int k, const Vec2& start, const Vec2& along, const Interval& t) {
        Random phase = stream(seed_, k, Use::phase), forward = stream(seed_, k, Use::forward),
               backward = stream(seed_, k, Use::backward);
        const double length = draw_length(set_.trace_length, phase);
        const double first = -phase.uniform() * length / set_.persistence;
        add_clipped(start, along, {first, first + length}, t);
        for (double at = first + length / set_.persistence; at < t.high;) {
            const double l = draw_length(set_.trace_length, forward);
            add_clipped(start, along, {at, at + l}, t);
            at += l / set_.persistence;
        }
        for (double at = first; at > t.low;) {
            const double l = draw_length(set_.trace_length, backward);
            at -= l / set_.persistence;
            add_clipped(start, along, {at, at + l}, t);
        }
    }

    void add_clipped(const Vec2& start, const Vec2& along, const Interval& piece, const Interval& t) {
        if (piece.low < t.high && piece.high > t.low)
            add_piece(start, along, {std::max(piece.low, t.low), std::min(piece.high, t.high)});
    }

    void add_piece(const Vec2& start, const Vec2& along, const Interval& piece) {
        const Vec2 from = start + piece.low * along, to = start + piece.high * along;
        if (set_.inside.empty()) {
            lines_.push_back({from, to, source_});
        } else {  // a little past the polygon: a region with the same outline is to be met in spite of rounding
            const Vec2 more = 1e-9 * Vec2(box_.xmax - box_.xmin, box_.ymax - box_.ymin).norm() * along;
            for (const auto& [a, b] : pieces_inside(set_.inside, from, to))
                lines_.push_back({a == from ? a : Vec2(a - more), b == to ? b : Vec2(b + more), source_});
        }
        if (lines_.size() > most_pieces) throw InputError("joint set " + set_.name + " has more than a million pieces");
    }

    const JointSetSpec& set_;
    const Box& box_;
    int source_;
    std::uint64_t seed_;
    Vec2 across_;
    std::vector<CutLine> lines_;
};

void check(const JointSetSpec& set, const Box& box) {
    const auto refuse = [&](const char* what) { throw InputError("joint set " + set.name + ": " + what); };
    if (!(set.spacing.mean > 0.0)) refuse("spacing must be positive");
    if (!(set.persistence > 0.0)) refuse("persistence must be positive");
    if (set.persistence < 1.0 && !(set.trace_length.mean > 0.0)) refuse("persistence below 1 needs a positive trace_length");
    if (set.angle.distribution == Distribution::lognormal || set.angle.distribution == Distribution::exponential)
        refuse("the distribution of an angle is normal or uniform");
    const double size = Vec2(box.xmax - box.xmin, box.ymax - box.ymin).norm();
    if (size / set.spacing.mean > static_cast<double>(most_pieces))
        refuse("spacing cuts the rock more than a million times");
}

}  // namespace

std::vector<CutLine> joint_set_lines(const JointSetSpec& set, const Box& box, int source) {
    check(set, box);
    return JointSetLines(set, box, source).run();
}

double tip_reach(const RockSpec& rock) {
    const Box box = bounds(rock.outline);
    return 1e-9 * Vec2(box.xmax - box.xmin, box.ymax - box.ymin).norm();
}

std::vector<CutLine> joint_lines(const RockSpec& rock) {
    const Box box = bounds(rock.outline);
    const Box grown = box.grown(0.01 * Vec2(box.xmax - box.xmin, box.ymax - box.ymin).norm());
    std::vector<CutLine> lines;
    int source = 0;
    for (const JointSetSpec& set : rock.joint_sets) {
        const std::vector<CutLine> more = joint_set_lines(set, grown, source++);
        lines.insert(lines.end(), more.begin(), more.end());
    }
    const double reach = tip_reach(rock);
    for (const CrackSpec& crack : rock.cracks) add_polyline(crack.points, reach, reach, source++, lines);
    if (rock.traces) {
        const TraceLines traces = trace_lines(*rock.traces, rock.outline, reach, source);
        lines.insert(lines.end(), traces.lines.begin(), traces.lines.end());
    }
    return lines;
}

}  // namespace talus
