#include "scenario/convert.hpp"
#include "scenario/outline.hpp"
#include "scenario/trace_file.hpp"

#include <filesystem>
#include <set>

namespace talus {
namespace {

std::string beside(const Reading& reading, const std::string& file) {
    return (std::filesystem::path(reading.folder) / file).string();  // an absolute path stays as it is
}

// Reads a file that the scenario names; what is wrong with it becomes a fault of the key.
template <class Read>
auto read_beside(const Cursor& at, Read read) -> decltype(read(std::string())) {
    try {
        return read(beside(at.reading(), at.text()));
    } catch (const InputError& error) {
        at.fault(error.what());
        return {};
    }
}

Spread convert_spread(const Cursor& at, double unit) {
    if (!at.is(Value::Kind::map)) return {unit * at.number()};
    const std::string& name = at["distribution"].text();
    const Distribution distribution = name == "uniform"       ? Distribution::uniform
                                      : name == "lognormal"   ? Distribution::lognormal
                                      : name == "exponential" ? Distribution::exponential
                                                              : Distribution::normal;
    return {unit * at["mean"].number(), unit * at["deviation"].number(), distribution};
}

std::vector<JointSetSpec> convert_joint_sets(const Cursor& sets) {
    std::vector<JointSetSpec> all;
    std::set<std::string> names;
    for (const Cursor& at : sets.items()) {
        JointSetSpec set;
        set.name = at["name"].text();
        set.angle = convert_spread(at["angle_deg"], radians(1.0));
        set.spacing = convert_spread(at["spacing"], 1.0);
        set.persistence = at["persistence"].number();
        set.trace_length = convert_spread(at["trace_length"], 1.0);
        set.origin = at["origin"].point();
        set.seed = static_cast<std::uint64_t>(at["seed"].number());
        set.joint = at["joint"].name_of("joint", at.reading().joints);
        set.inside = read_region_at(at["inside"]);
        if (!names.insert(set.name).second) at["name"].fault("a joint set of this name is there already");
        all.push_back(std::move(set));
    }
    return all;
}

std::vector<CrackSpec> convert_cracks(const Cursor& cracks) {
    std::vector<CrackSpec> all;
    for (const Cursor& at : cracks.items()) {
        CrackSpec crack{at["points"].points(), at["joint"].name_of("joint", at.reading().joints)};
        for (std::size_t i = 1; i < crack.points.size(); ++i)
            if (crack.points[i] == crack.points[i - 1])
                at["points"].fault("point [" + std::to_string(i) + "] repeats point [" + std::to_string(i - 1) + "]");
        all.push_back(std::move(crack));
    }
    return all;
}

TraceMapSpec convert_traces(const Cursor& at) {
    TraceMapSpec traces;
    traces.where = at.where();
    traces.file = at["file"].text();
    if (at["file"].given()) traces.lines = read_beside(at["file"], read_traces);
    for (auto& line : traces.lines)
        for (Vec2& point : line) point -= at.reading().origin;
    traces.extend = at["extend"].number();
    traces.snap = at["snap"].number();
    traces.joint = at["joint"].name_of("joint", at.reading().joints);
    return traces;
}

SideSupport convert_side(const Cursor& at) {
    if (at.is(Value::Kind::text)) return SideSupport::roller;
    return at.yes() ? SideSupport::held : SideSupport::none;
}

HeldSpec convert_held(const Cursor& at) {
    HeldSpec held;
    held.left = convert_side(at["left"]);
    held.right = convert_side(at["right"]);
    held.bottom = convert_side(at["bottom"]);
    held.top = convert_side(at["top"]);
    const double y = at.reading().origin.y();
    if (at["below"].given()) held.below = at["below"].number() - y;
    if (at["above"].given()) held.above = at["above"].number() - y;
    for (const Cursor& inside : at["inside"].items()) held.inside.push_back(read_region_at(inside));
    return held;
}

RegionSpec convert_region(const std::string& name, const Cursor& at) {
    return {name, at["circle"].given() ? read_circle_at(at["circle"]) : read_outline_at(at["outline"]),
            at["material"].name_of("material", at.reading().materials)};
}

Polygon convert_rock_outline(const Cursor& rock) {
    const Cursor file = rock["outline_file"];
    if (!file.given()) return read_outline_at(rock["outline"]);
    Polygon outline = read_beside(file, read_outline);
    for (Vec2& corner : outline) corner -= rock.reading().origin;
    return outline.empty() ? outline : as_outline(outline, file);
}

}  // namespace

RockSpec convert_rock(const Cursor& at) {
    RockSpec rock;
    rock.where = at.where();
    rock.outline = convert_rock_outline(at);
    rock.outline_file = at["outline_file"].text();
    if (!at["material"].given()) at["material"].fault("is missing: name of a material");
    rock.material = at["material"].name_of("material", at.reading().materials);
    rock.joint_sets = convert_joint_sets(at["joint_sets"]);
    rock.cracks = convert_cracks(at["cracks"]);
    if (at["traces"].given()) rock.traces = convert_traces(at["traces"]);
    for (const Cursor& hole : at["holes"].items()) rock.holes.push_back(read_region_at(hole));
    for (const auto& [name, region] : at["regions"].names()) rock.regions.push_back(convert_region(name, region));
    rock.held = convert_held(at["held"]);
    const Cursor slivers = at["slivers"];
    rock.slivers = {slivers["area"].number(), slivers["width"].number(),
                    slivers["area"].given() || slivers["width"].given()};
    return rock;
}

}  // namespace talus
