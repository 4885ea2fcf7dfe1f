// Safe regions while boxes hardly move against each other. While they mix: Verlet lists, or, for few boxes, incremental
// sorting. The motion itself tells.
#include "contact/moving_search.hpp"
#include "contact/search_methods.hpp"

#include <algorithm>
#include <utility>

namespace talus {
namespace {

class AutoSearch final : public PairSearch {
public:
    void update(std::span<const Box> boxes) override {
        search_->update(boxes);
        const double n = std::max(1.0, static_cast<double>(boxes.size()));
        if (++steps_ == 1) return;  // the first builds
        activity_ += (std::min(happened() / n, 1.0) - activity_) / std::min(steps_ - 1, memory);
        if (--wait_ > 0 || !(way_ == Way::regions ? activity_ > lively() : activity_ < calm())) return;
        change(boxes);
        patience_ = std::min(2 * patience_, 4096);
        wait_ = patience_;
    }

    void pairs(std::vector<Pair>& pairs) const override { search_->pairs(pairs); }
    std::string choice() const override {
        return way_ == Way::sorting ? "isu-separated, for few boxes that mix" : search_->choice();
    }

private:
    enum class Way { regions, lists, sorting };

    // Where one box in a hundred is looked at in each step, that takes as long as comparing all pairs of all lists, and one
    // may go either way. Back only when much less happens: each change costs as much as dozens of steps.
    // In the first steps, while speeds are not known, regions are too large for many boxes in any scene.
    double lively() const { return steps_ < 4 * memory ? 0.2 : 0.01; }
    double calm() const { return way_ == Way::lists ? 0.001 : 0.1; }
    static constexpr int memory = 16;  // steps

    // What the last update had to do one by one: boxes, or exchanges of ends.
    double happened() {
        if (moving_) return moving_->looked_at();
        return static_cast<double>(search_->exchanges() - std::exchange(exchanges_, search_->exchanges()));
    }

    void change(std::span<const Box> boxes) {
        const std::vector<float> speeds = moving_ ? moving_->speeds() : std::vector<float>{};
        way_ = way_ != Way::regions ? Way::regions : few(boxes, speeds) ? Way::sorting : Way::lists;
        if (way_ == Way::sorting) {
            moving_ = nullptr;
            search_ = make_isu_separated_search();
        } else {
            auto next = way_ == Way::regions ? make_safe_regions() : make_verlet_lists();
            next->expect(speeds);
            moving_ = next.get();
            search_ = std::move(next);
        }
        search_->update(boxes);
        exchanges_ = search_->exchanges();
        activity_ = way_ == Way::regions ? 0.0 : 1.0;
    }

    // Ends of sqrt(N) boxes lie side by side along an axis: sorting costs as sqrt(N) x speed, lists cost as sqrt(speed).
    // They meet where N x speed is 18 sizes of a box, at 2,000 boxes that move a hundredth of their size.
    static bool few(std::span<const Box> boxes, std::vector<float> speeds) {
        std::vector<float> sizes;
        for (const Box& b : boxes)
            if (present(b)) sizes.push_back(static_cast<float>(std::max(b.xmax - b.xmin, b.ymax - b.ymin)));
        if (sizes.empty() || speeds.empty()) return true;
        for (auto* each : {&sizes, &speeds})
            std::nth_element(each->begin(), each->begin() + std::ssize(*each) / 2, each->end());
        return static_cast<double>(boxes.size()) * speeds[speeds.size() / 2] < 18.0 * sizes[sizes.size() / 2];
    }

    Way way_ = Way::regions;
    std::unique_ptr<PairSearch> search_ = make_safe_regions();
    MovingSearch* moving_ = static_cast<MovingSearch*>(search_.get());  // the same, or none
    double activity_ = 0.0;
    std::int64_t exchanges_ = 0;
    int steps_ = 0;
    int patience_ = memory, wait_ = 3;  // steps until the next change
};

}  // namespace

std::unique_ptr<PairSearch> make_auto_search() { return std::make_unique<AutoSearch>(); }
std::unique_ptr<PairSearch> make_safe_regions_search() { return make_safe_regions(); }
std::unique_ptr<PairSearch> make_verlet_search() { return make_verlet_lists(); }

}  // namespace talus
