// Whether the joints of a scene need their springs.
#pragma once

#include "model/burden.hpp"
#include "model/model.hpp"
#include "scenario/scenario.hpp"

#include <string>
#include <vector>

namespace talus {

/// A stage, or the run, which is the last one.
struct StageView {
    std::string name;
    std::string* solver;
    const Until* until;
    const DampingSpec* damping;
    std::optional<double>* time_step;
    bool settle, open;  // open: its solver is to be chosen
    bool timeless() const { return until->equilibrium && !until->time; }
};
std::vector<StageView> stages_of(Scenario& scenario);

struct Need {
    std::string why;            // empty: blocks with rigid joints do
    bool give_is_error = true;  // what joints of the stiffness given close is error; else it is part of the answer
    bool open_is_error = true;  // likewise of those whose stiffness is left open
    /// What is asked for is the give of joints itself: no accuracy knows it, and nothing can be left open.
    bool gives_answer = false;
    bool at_rest = false;     // forces in equilibrium alone are asked for
    std::string remedy = {};  // what a scenario may state so that it needs no springs
};

/// What a scenario asks for, or has, that blocks with rigid joints have not.
Need need_of_springs(const Scenario& scenario, const std::vector<StageView>& stages, const Model& model,
                     const Burden& burden);

/// Something moves as a table says, which takes time.
bool takes_time(const Scenario& scenario);

/// Of some joint, 0 or more.
bool has_restitution(const Scenario& scenario);

/// Of some joint, which rebounds.
bool rebounds(const Scenario& scenario);

}  // namespace talus
