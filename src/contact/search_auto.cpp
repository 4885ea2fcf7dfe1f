// Safe regions while boxes hardly move against each other, Verlet lists while they mix. What the two have to do tells.
#include "contact/moving_search.hpp"
#include "contact/search_methods.hpp"

#include <algorithm>
#include <cmath>

namespace talus {
namespace {

/// How fast boxes move, from the first two steps: a few of them, against what most of them do.
class FirstLook {
public:
    void note(std::span<const Box> boxes) {
        n_ = boxes.size();
        for (std::size_t i = 0; i < n_; i += every()) sample_.push_back(boxes[i]);
    }

    /// Mean of how far a box went / its size; 0 where that cannot be said.
    double pace(std::span<const Box> boxes) {
        if (boxes.size() != n_) return 0.0;
        std::vector<double> x, y;
        for (std::size_t k = 0; k < sample_.size(); ++k) {
            const Box &then = sample_[k], &now = boxes[k * every()];
            if (!present(then) || !present(now)) continue;
            const double size = std::max(now.xmax - now.xmin, now.ymax - now.ymin);
            const double along_x = (now.xmin - then.xmin) / size, along_y = (now.ymin - then.ymin) / size;
            if (!std::isfinite(along_x + along_y)) continue;
            x.push_back(along_x), y.push_back(along_y);
        }
        if (x.empty()) return 0.0;
        double sum = 0.0;
        const double common_x = median(x), common_y = median(y);
        for (std::size_t k = 0; k < x.size(); ++k)
            sum += std::min(std::max(std::abs(x[k] - common_x), std::abs(y[k] - common_y)), 1.0);
        return sum / static_cast<double>(x.size());
    }

private:
    std::size_t every() const { return n_ / 256 + 1; }
    static double median(std::vector<double> values) {
        const auto middle = values.begin() + std::ssize(values) / 2;
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    }

    std::size_t n_ = 0;
    std::vector<Box> sample_;
};

class AutoSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        if (++steps_ == 1) first_look_.note(boxes);
        if (steps_ == 2) {
            const double pace = first_look_.pace(boxes);
            if (cost_of_regions(pace) > cost_of_lists) change(speeds(boxes, pace));
            first_look_ = {};
        }
        search_->update(boxes);
        if (steps_ == 1) return;  // it builds
        const MovingSearch::Costs now = search_->costs();
        const int counted = std::min(++counted_, memory);
        mine_ += (std::min(now.mine, worst) - mine_) / counted;
        other_ += ((lists_ ? regions_now(now.other) : now.other) - other_) / counted;
        // In the first steps, while speeds are not known, regions are too large for many boxes in any scene.
        if (--wait_ > 0 || mine_ < (steps_ < 4 * memory ? 10.0 : worth_it()) * other_) return;
        change(search_->speeds());
        search_->update(boxes);
    }

    void pairs(std::vector<Pair>& pairs) const override { search_->pairs(pairs); }
    std::string choice() const override { return search_->choice(); }

private:
    // To make lists takes as long as some ten steps, to make regions as long as a hundred.
    double worth_it() const { return lists_ ? 1.3 : 1.0; }
    static constexpr double worst = 300.0;  // ns: a single blow is no reason
    static constexpr int memory = 16;       // steps

    /// ns: what regions would take. If they took more than is usual for the pace when they were left, they will again.
    double regions_now(double usual) {
        if (regions_were_ > 0.0) {
            hard_ = std::max(1.0, (regions_were_ - cost_at_rest) / std::max(usual - cost_at_rest, 0.1));
            regions_were_ = 0.0;
        }
        return cost_at_rest + hard_ * (usual - cost_at_rest);
    }

    static std::vector<float> speeds(std::span<const Box> boxes, double pace) {
        std::vector<float> speeds;
        for (const Box& b : boxes)
            speeds.push_back(present(b) ? static_cast<float>(pace * std::max(b.xmax - b.xmin, b.ymax - b.ymin)) : 0.0F);
        return speeds;
    }

    void change(const std::vector<float>& speeds) {
        lists_ = !lists_;
        search_ = lists_ ? make_verlet_lists() : make_safe_regions();
        search_->expect(speeds);
        regions_were_ = lists_ ? mine_ : 0.0;
        mine_ = other_ = 0.0, counted_ = 0;
        patience_ = std::min(2 * patience_, 4096);
        wait_ = patience_;
    }

    bool lists_ = false;
    std::unique_ptr<MovingSearch> search_ = make_safe_regions();
    FirstLook first_look_;
    double mine_ = 0.0, other_ = 0.0;  // ns per box, means over the last steps
    double regions_were_ = 0.0, hard_ = 1.0;
    int steps_ = 0, counted_ = 0;
    int patience_ = memory, wait_ = 3;  // steps until the next change
};

}  // namespace

std::unique_ptr<PairSearch> make_auto_search() { return std::make_unique<AutoSearch>(); }
std::unique_ptr<PairSearch> make_safe_regions_search() { return make_safe_regions(); }
std::unique_ptr<PairSearch> make_verlet_search() { return make_verlet_lists(); }

}  // namespace talus
