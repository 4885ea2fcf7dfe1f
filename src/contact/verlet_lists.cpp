// Verlet lists: L. Verlet, Phys. Rev. 159 (1967) 98-103, of boxes and groups of eight, with a margin for each box of its
// own.
//
// Every box has a coarse box, larger than itself by as far as it will probably go while the lists last. Boxes that lie near
// each other form groups of eight (box_groups.hpp); a box and a group that its coarse box reaches are compared at every
// step, eight pairs at once. To list all boxes anew takes a few steps' time, so it is done as soon as many have left their
// coarse boxes; until then those that do are put into groups of their own at the end, each compared with all it may reach.
#include "contact/box_groups.hpp"
#include "contact/moving_search.hpp"
#include "contact/near_boxes.hpp"
#include "contact/pair_set.hpp"
#include "contact/regions.hpp"
#include "contact/search_methods.hpp"
#include "contact/spatial_order.hpp"
#include "contact/threads.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

namespace talus {
namespace {

constexpr int width = BoxGroups::width;

class VerletLists final : public MovingSearch {
public:
    void update(std::span<const Box> boxes) override {
        boxes_ = boxes;
        ++step_;
        if (std::ssize(boxes) != n_) {
            n_ = static_cast<int>(boxes.size());
            if (std::ssize(speed_) != n_) speed_.assign(n_, 0.0F);
            start_anew();
        } else {
            view_.follow(boxes_, false);
            refresh();
            if (view_.gone_too_far())
                start_anew();
            else
                look_at_escaped();
        }
        compare();
        boxes_ = {};
    }

    void pairs(std::vector<Pair>& pairs) const override {
        std::vector<Pair> found;
        found.reserve(2 * static_cast<std::size_t>(n_));
        const auto tell = [&](int place, int group, unsigned overlaps) {
            for (; overlaps != 0; overlaps &= overlaps - 1) {
                const int i = groups_.box[place], j = groups_.box[width * group + std::countr_zero(overlaps)];
                found.push_back({std::min(i, j), std::max(i, j)});
            }
        };
        for (int place = 0; place < width * groups_.size(); ++place) tell(place, place / width, groups_.own[place]);
        for (std::size_t k = 0; k < groups_.rows.size(); ++k)
            tell(static_cast<int>(groups_.rows[k].place), static_cast<int>(groups_.rows[k].group), groups_.found[k]);
        sort_pairs(n_, found, pairs);
    }

    // To build takes 100 ns.
    Costs costs() const override {
        return {4.0 + 2.0 * static_cast<double>(groups_.rows.size()) / std::max(n_, 1) + 100.0 / duration_,
                cost_of_regions(pace_)};
    }
    std::vector<float> speeds() const override { return speed_; }
    void expect(const std::vector<float>& speeds) override { speed_ = speeds; }

    std::string choice() const override {
        if (step_ == 0) return {};
        char text[120];
        std::snprintf(text, sizeof text,
                      "Verlet lists, %.2g steps between new ones, each box compared with %.2g groups of %d",
                      static_cast<double>(step_) / std::max(builds_, 1),
                      1.0 + static_cast<double>(groups_.rows.size()) / std::max(n_, 1), width);
        return text;
    }

private:
    struct Track {     // of a coarse box
        float margin;  // m
        int since;     // step
    };

    Box seen(int i) const { return view_.seen(boxes_[i]); }

    /// m: what the motion of a box is compared with. A wide margin around a very large box would meet very many groups.
    double size_of(const Box& b) const {
        const double own = std::max(b.xmax - b.xmin, b.ymax - b.ymin) + 0.1 * view_.typical();
        return own < 8.0 * view_.typical() ? own : 8.0 * view_.typical();
    }

    // ---- all boxes ---------------------------------------------------------------------------------------------------

    void start_anew() {
        view_.choose(boxes_);
        track_.assign(n_, {0.0F, step_});
        groups_ = {};
        build();
    }

    void build() {
        ++builds_;
        built_ = step_;
        for (int place = 0; place < width * groups_.size(); ++place) measure_speed(place);
        choose_duration();
        const std::vector<int> order = spatial_order(boxes_, view_, width);
        groups_.box.clear(), groups_.own.clear(), groups_.bounds.clear(), groups_.limits.clear();
        groups_.rows.clear();
        groups_.resize(static_cast<int>(std::ssize(order)) / width);
        for (std::size_t place = 0; place < order.size(); ++place)
            if (order[place] >= 0) settle(order[place], static_cast<int>(place));
        find_absent();
        list_groups();
        refresh();
    }

    // Longer lists are longer and last longer. Half and twice of the 8 cost up to a tenth.
    void choose_duration() {
        double sum = 0.0;
        for (int i = 0; i < n_; ++i) {
            const double pace = speed_[i] / size_of(boxes_[i]);
            if (pace > 0.0) sum += std::min(pace, 1.0);  // not for what is not a number
        }
        pace_ = sum / std::max(n_, 1);
        duration_ = std::clamp(std::sqrt(8.0 / std::max(pace_, 1e-9)), 4.0, 256.0);
    }

    void find_absent() {
        absent_.clear();
        for (int i = 0; i < n_; ++i)
            if (!present(boxes_[i])) absent_.push_back(i);
    }

    void list_groups() {
        sorted_groups_ = groups_.size();
        next_ = width * sorted_groups_;
        outer_.resize(sorted_groups_ + 1);
        std::vector<CoarseBox> reach;
        std::vector<Box> reach_as_boxes;
        for (int g = 0; g < sorted_groups_; ++g) {
            const CoarseBox r = reach.emplace_back(groups_.reach(g));
            outer_.set(g, reach_as_boxes.emplace_back(Box{r.xmin, r.ymin, r.xmax, r.ymax}));
        }
        std::vector<Pair> near;
        make_grid_search()->find(reach_as_boxes, near);
        list_rows(groups_, reach, near);
        groups_.found.resize(groups_.rows.size());
    }

    void refresh() {
        escaped_.clear();
        const int groups = groups_.size(), threads = n_ < 4000 ? 1 : threads_allowed();
        std::vector<std::vector<int>> found(threads);
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int t = 0; t < threads; ++t) {
            const auto at = [&](int k) { return static_cast<int>(static_cast<std::int64_t>(groups) * k / threads); };
            refresh_groups(boxes_, view_.centre(), groups_, at(t), at(t + 1), found[t]);
        }
        for (const auto& each : found) escaped_.insert(escaped_.end(), each.begin(), each.end());
    }

    void compare() {
        const auto rows = static_cast<std::int64_t>(groups_.rows.size());
        const int threads = n_ < 4000 ? 1 : threads_allowed();
#pragma omp parallel for schedule(static) num_threads(threads)
        for (int t = 0; t < threads; ++t) compare_rows(groups_, rows * t / threads, rows * (t + 1) / threads);
    }

    // ---- one box -----------------------------------------------------------------------------------------------------

    // Gives a box its place and its coarse box.
    void settle(int i, int place) {
        const double size = size_of(boxes_[i]);
        const double way = 1.2 * duration_ * speed_[i];
        const double margin = way > 0.02 * size ? std::min(way, 0.6 * size) : 0.02 * size;
        groups_.box[place] = i;
        groups_.enclose(place, coarse(seen(i), margin));
        track_[i] = {static_cast<float>(margin), step_};
    }

    void measure_speed(int place) {
        const int i = groups_.box[place];
        if (i < 0 || !present(boxes_[i]) || track_[i].since == step_) return;
        const CoarseBox from = groups_.coarse_box(place);
        const double margin = track_[i].margin;
        const Box then{from.xmin + margin, from.ymin + margin, from.xmax - margin, from.ymax - margin};
        const double speed = farthest(seen(i), then) / (step_ - track_[i].since);
        speed_[i] = view_.believable(speed) ? static_cast<float>(speed) : 0.0F;
    }

    void look_at_escaped() {
        const int settled_anew = next_ - width * sorted_groups_;
        // 4,000 of a million take half as long as to list all.
        const bool many = std::ssize(escaped_) + settled_anew > std::max(width, std::min(n_ / 32, 4000));
        if (many || step_ - built_ > 2.0 * duration_) return build();  // after long, to see whether boxes became slower
        left_.swap(escaped_);
        for (const int place : left_) {
            const int i = groups_.box[place];
            measure_speed(place);
            groups_.vacate(place);
            refresh_one(place / width);
            present(boxes_[i]) ? settle_anew(i) : absent_.push_back(i);
        }
        std::erase_if(absent_, [&](int i) {
            if (!present(boxes_[i])) return false;
            settle_anew(i);
            return true;
        });
    }

    // In a group behind all others: only those that come later are compared with it by themselves.
    void settle_anew(int i) {
        const int place = next_++, group = place / width;
        if (group == groups_.size()) groups_.resize(group + 1);
        settle(i, place);
        refresh_one(group);
        const CoarseBox mine = groups_.coarse_box(place);
        outer_.set(sorted_groups_, {mine.xmin, mine.ymin, mine.xmax, mine.ymax});
        near_.resize(sorted_groups_ + 16);
        static const FindNear find_near = rarely_near_kernel(best_vector_unit());
        const int near = find_near(outer_, sorted_groups_, 0, sorted_groups_, near_.data());
        const unsigned lane = 1u << (place % width);
        for (int k = 0; k < near; ++k) groups_.add_rows(group, lane, near_[k]);
        for (int g = sorted_groups_; g < group; ++g)
            if (groups_.near(g, mine)) groups_.add_rows(group, lane, g);
        groups_.found.resize(groups_.rows.size());
    }

    void refresh_one(int group) { refresh_groups(boxes_, view_.centre(), groups_, group, group + 1, escaped_); }

    std::span<const Box> boxes_;  // during update() only
    int n_ = 0, step_ = 0, builds_ = 0, built_ = 0;
    Viewpoint view_;
    double pace_ = 0.0;      // mean of speed / size, 1/step
    double duration_ = 1.0;  // steps that lists shall last

    BoxGroups groups_;
    int sorted_groups_ = 0;  // those behind them hold boxes that left their coarse boxes
    int next_ = 0;           // the first place behind all
    RoundedBoxes outer_;     // [sorted groups + 1] around the coarse boxes of each
    std::vector<Track> track_;
    std::vector<float> speed_;  // [n] m per step
    std::vector<int> absent_;
    std::vector<int> escaped_, left_, near_;
};

}  // namespace

std::unique_ptr<MovingSearch> make_verlet_lists() { return std::make_unique<VerletLists>(); }

}  // namespace talus
