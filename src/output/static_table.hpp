// Names of the evidence of static stages in files, in one place.
#pragma once

#include "model/state.hpp"

namespace talus {

/// Calls visit(name, member) for every column; one row per static stage.
template <class Visit>
void for_each_evidence(Visit&& visit) {
    [[maybe_unused]] const auto& [stage, reached, moving, ratio, drift, loading_ratio, iterations, evaluations, increments,
                                  newton_steps] = StaticEvidence{};  // a new member must be named here
    visit("stage", &StaticEvidence::stage);
    visit("reached", &StaticEvidence::reached);
    visit("moving", &StaticEvidence::moving);
    visit("ratio", &StaticEvidence::ratio);
    visit("drift", &StaticEvidence::drift);
    visit("loading_ratio", &StaticEvidence::loading_ratio);
    visit("iterations", &StaticEvidence::iterations);
    visit("evaluations", &StaticEvidence::evaluations);
    visit("increments", &StaticEvidence::increments);
    visit("newton_steps", &StaticEvidence::newton_steps);
}

/// The static stages of a run so far; the one that runs now comes last, if it has begun.
inline std::vector<StaticEvidence> static_stages(const Statics& statics) {
    std::vector<StaticEvidence> all = statics.earlier;
    if (statics.now.iterations > 0) all.push_back(statics.now);
    return all;
}

}  // namespace talus
