// Hierarchical grid: boxes lie in cells of their own size, whatever the sizes beside them (D. Krijgsman, V. Ogarko & S.
// Luding, Computational Particle Mechanics 1 (2014) 357-372). Made anew at each step.
#include "contact/near_boxes.hpp"
#include "contact/pair_set.hpp"
#include "contact/search_methods.hpp"
#include "contact/threads.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <numeric>

namespace talus {
namespace {

/// Powers of two, counted as in the format of a double: the side of a cell of exponent e is 2^(e - 1022) m, larger than
/// every number of that exponent, and at most twice as large.
int exponent(double number) { return static_cast<int>((std::bit_cast<std::uint64_t>(number) >> 52) & 2047); }
double side(int exponent) { return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1) << 52); }

std::int64_t floor_of(double number) {  // std::floor is a call where the processor may be old
    const auto cut = static_cast<std::int64_t>(number);
    return cut - (number < static_cast<double>(cut));
}

constexpr int beyond = 1023 + 60;  // exponent of lengths that cannot be counted in cells: 1e18 m

int size(const Box& box) { return exponent(std::max(box.xmax - box.xmin, box.ymax - box.ymin)); }

int reach(const Box& box) {
    return std::max({exponent(box.xmin), exponent(box.xmax), exponent(box.ymin), exponent(box.ymax)});
}

/// The cells of one size, for boxes that are smaller. A box lies in the cell of its lower left corner, which is found
/// without rounding, so that boxes that overlap lie in the same cell or in cells side by side. The plane is wrapped around a
/// table with a power of two of columns and rows: wherever the boxes lie, there are at most four times as many cells as
/// boxes.
struct Level {
    static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();

    double cells_per_m = 0.0;
    std::int64_t boxes = 0;
    std::int64_t xmin = none, ymin = none, xmax = -none, ymax = -none;  // cells
    std::int64_t columns = 0, rows = 0, first = 0;                      // first: of its cells, among those of all levels

    std::int64_t cell(double at) const { return floor_of(at * cells_per_m); }
    std::int64_t row(std::int64_t y) const { return first + (y & (rows - 1)) * columns; }
    std::int64_t column(std::int64_t x) const { return x & (columns - 1); }

    void take(const Box& box) {
        const std::int64_t x = cell(box.xmin), y = cell(box.ymin);
        xmin = std::min(xmin, x), xmax = std::max(xmax, x), ymin = std::min(ymin, y), ymax = std::max(ymax, y);
        ++boxes;
    }

    /// At least four by four, so that no cell is its own neighbour, or that of another on both sides.
    void lay_out(std::int64_t first_cell) {
        const auto power_of_two = [](std::int64_t extent) {
            return static_cast<std::int64_t>(
                std::bit_ceil(static_cast<std::uint64_t>(std::clamp<std::int64_t>(extent, 4, 1 << 30))));
        };
        columns = power_of_two(xmax - xmin + 1), rows = power_of_two(ymax - ymin + 1);
        while (columns * rows > std::max<std::int64_t>(16, 4 * boxes)) (columns > rows ? columns : rows) /= 2;
        first = first_cell;
    }
};

/// The median of the sizes counted, of those that are not zero.
int median(std::span<const std::int64_t> of_size) {
    const std::int64_t all = std::accumulate(of_size.begin() + 1, of_size.end(), std::int64_t{0});
    int e = 1;
    for (std::int64_t below = of_size[1]; 2 * below < all; below += of_size[e]) ++e;
    return e;
}

class GridSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        boxes_ = boxes.size();
        choose_levels(boxes);
        fill(boxes);
        const int threads = boxes.size() >= worth_sharing ? threads_allowed() : 1;
        found_.resize(threads);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
        for (int part = 0; part < threads; ++part) search_part(part, threads);
        pairs_.clear();
        for (const Found& found : found_)
            pairs_.insert(pairs_.end(), found.pairs.begin(), found.pairs.begin() + found.count);
        compare_giants(boxes);
    }

    void pairs(std::vector<Pair>& pairs) const override { sort_pairs(boxes_, pairs_, pairs); }

private:
    /// Room for pairs, the first `count` of them found: what may turn out to be none is written, too, and then written over.
    struct Found {
        std::vector<Pair> pairs;
        std::ptrdiff_t count = 0;
        std::vector<int> near;  // places of boxes that may overlap the one at hand
        int near_count = 0;
    };

    static constexpr std::size_t worth_sharing = 1000;  // boxes; fewer are done before the threads have started
    static constexpr int absent = -1, giant = -2;

    /// Sizes that occur get a level, smallest first: one for each power of four, because small boxes have to look through
    /// all levels above them and several boxes of a cell are compared at once; powers of two are 1.6 times as slow. The very
    /// small sizes share one: their places could not be counted in cells.
    void choose_levels(std::span<const Box> boxes) {
        std::array<std::int64_t, 2048> of_size{};
        level_of_.resize(boxes.size());
        giants_.clear();
        int farthest = 0;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const int far = reach(boxes[i]);
            level_of_[i] = !present(boxes[i]) ? absent : far >= beyond ? giant : size(boxes[i]);
            if (level_of_[i] == giant) giants_.push_back(static_cast<int>(i));
            if (level_of_[i] < 0) continue;
            farthest = std::max(farthest, far);
            ++of_size[level_of_[i]];
        }
        const int usual = median(of_size), smallest = std::max({1, farthest - 61, usual - 12});
        std::array<int, 2048> level_of_size{};
        level_.clear();
        bool any = false;
        for (int e = 0; e < 2048; ++e) {
            any |= of_size[e] > 0;
            level_of_size[e] = static_cast<int>(level_.size());
            if (!any || e < smallest || (e - usual) % 2 != 0) continue;
            level_.emplace_back().cells_per_m = 1.0 / side(e);
            any = false;
        }
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (level_of_[i] < 0) continue;
            level_of_[i] = level_of_size[level_of_[i]];
            level_[level_of_[i]].take(boxes[i]);
        }
    }

    /// Sorts the boxes into the cells by counting.
    void fill(std::span<const Box> boxes) {
        std::int64_t cells = 0;
        for (Level& level : level_) {
            level.lay_out(cells);
            cells += level.columns * level.rows;
        }
        begin_.assign(cells + 2, 0);
        cell_.resize(boxes.size());
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (level_of_[i] < 0) continue;
            const Level& level = level_[level_of_[i]];
            cell_[i] = level.row(level.cell(boxes[i].ymin)) + level.column(level.cell(boxes[i].xmin));
            ++begin_[cell_[i] + 2];
        }
        for (std::int64_t c = 0; c < cells; ++c) begin_[c + 2] += begin_[c + 1];
        box_.resize(begin_[cells + 1]);
        id_.resize(begin_[cells + 1]);
        rounded_.resize(begin_[cells + 1]);
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (level_of_[i] < 0) continue;
            const int place = begin_[cell_[i] + 1]++;
            box_[place] = boxes[i];
            rounded_.set(place, boxes[i]);
            id_[place] = static_cast<int>(i);
        }
    }

    void search_part(int part, int parts) {
        Found& found = found_[part];
        found.count = 0;
        found.near.resize(box_.size() + 64);  // each once, and what the registers write beyond
        for (std::size_t l = 0; l < level_.size(); ++l) {
            const Level& level = level_[l];
            const std::int64_t from = level.rows * part / parts, to = level.rows * (part + 1) / parts;
            for (std::int64_t y = from; y < to; ++y) among(level, y, found);
            for (std::size_t above = l + 1; above < level_.size(); ++above)
                between(begin_[level.row(0) + from * level.columns], begin_[level.row(0) + to * level.columns],
                        level_[above], found);
        }
    }

    /// Pairs of one level: each cell of a row with itself, the next one and the three above.
    void among(const Level& level, std::int64_t y, Found& found) {
        for (std::int64_t x = 0; x < level.columns; ++x) {
            const std::int64_t cell = level.row(y) + x;
            const bool last = x + 1 == level.columns;
            for (int k = begin_[cell]; k < begin_[cell + 1]; ++k) {
                look(k, k + 1, begin_[cell + (last ? 1 : 2)], found);
                if (last) look_in_row(k, level, y, 0, 1, found);
                look_in_row(k, level, y + 1, x - 1, 3, found);
                meet(k, found);
            }
        }
    }

    /// Pairs of smaller boxes at the places [from, to) with those of a level above, whose lower left corners lie less than a
    /// cell before them.
    void between(int from, int to, const Level& level, Found& found) {
        for (int k = from; k < to; ++k) {
            const Box& box = box_[k];
            const std::int64_t x = level.cell(box.xmin) - 1, count = level.cell(box.xmax) - x + 1;
            for (std::int64_t y = level.cell(box.ymin) - 1, last = level.cell(box.ymax); y <= last; ++y)
                look_in_row(k, level, y, x, count, found);
            meet(k, found);
        }
    }

    void look_in_row(int k, const Level& level, std::int64_t y, std::int64_t x, std::int64_t count, Found& found) {
        const std::int64_t row = level.row(y), column = level.column(x);
        const std::int64_t until_wrap = std::min(count, level.columns - column);
        look(k, begin_[row + column], begin_[row + column + until_wrap], found);
        if (until_wrap < count) look(k, begin_[row], begin_[row + count - until_wrap], found);
    }

    void look(int k, int from, int to, Found& found) {
        found.near_count += find_near_(rounded_, k, from, to, found.near.data() + found.near_count);
    }

    /// Takes those seen near that overlap. A branch would often be guessed wrong.
    void meet(int k, Found& found) {
        if (found.count + found.near_count > std::ssize(found.pairs))
            found.pairs.resize(2 * (found.pairs.size() + found.near_count));
        const Box mine = box_[k];
        const int id = id_[k];
        Pair* next = found.pairs.data() + found.count;
        for (int i = 0; i < found.near_count; ++i) {
            const int place = found.near[i];
            const Box& other = box_[place];
            *next = {std::min(id, id_[place]), std::max(id, id_[place])};
            next += (mine.xmin <= other.xmax) & (other.xmin <= mine.xmax) & (mine.ymin <= other.ymax) &
                    (other.ymin <= mine.ymax);
        }
        found.count = next - found.pairs.data();
        found.near_count = 0;
    }

    /// Boxes that reach beyond all cells are compared with every other.
    void compare_giants(std::span<const Box> boxes) {
        for (const int g : giants_)
            for (int i = 0; i < static_cast<int>(boxes.size()); ++i)
                if (level_of_[i] != absent && (level_of_[i] != giant || i > g) && boxes[g].overlaps(boxes[i]))
                    pairs_.push_back({std::min(g, i), std::max(g, i)});
    }

    const FindNear find_near_ = near_kernel(best_vector_unit());
    std::vector<Level> level_;
    std::vector<int> level_of_;       // [number of boxes], or absent, or giant
    std::vector<std::int64_t> cell_;  // [number of boxes]
    std::vector<int> begin_;          // boxes of cell c are at the places [begin_[c], begin_[c + 1])
    std::vector<Box> box_;            // [number of boxes in cells], cell by cell
    RoundedBoxes rounded_;            // the same
    std::vector<int> id_;             // of the same boxes
    std::vector<int> giants_;
    std::vector<Found> found_;  // by each thread
    std::vector<Pair> pairs_;
    std::size_t boxes_ = 0;
};

}  // namespace

std::unique_ptr<PairSearch> make_grid_search() { return std::make_unique<GridSearch>(); }

}  // namespace talus
