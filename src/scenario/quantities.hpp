// The closed list of numbers that can be observed: by `record.history` while a run goes on, by `expect` when it has ended.
#pragma once

#include <string>
#include <vector>

namespace talus {

struct Quantity {
    enum class Place { body, block, joint, scene, any };  // body: a point or a block; scene: no place; any: body or scene
    std::string name, unit;
    Place place;
    std::vector<std::string> components;  // empty: one number
    std::string component;                // default of `expect`; empty: must be given
    bool history;                         // can be recorded; false: computed by `expect` from a history
    std::string meaning;
};

const std::vector<Quantity>& quantities();
const Quantity* find_quantity(const std::string& name);
std::string place_text(Quantity::Place place);  // "point or block", "joint", ...

}  // namespace talus
