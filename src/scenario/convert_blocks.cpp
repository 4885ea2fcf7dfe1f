// Single blocks: shapes, arches and repetitions become plain outlines with names.
#include "scenario/convert.hpp"
#include "scenario/outline.hpp"

#include <cmath>
#include <set>

namespace talus {
namespace {

struct Copy {  // one of several blocks made from one item
    std::string suffix;
    Vec2 moved = Vec2::Zero();
};

struct Piece {
    std::string suffix;
    Polygon outline;
};

Polygon rectangle(const Cursor& at) {
    const Vec2 corner = at["corner"].point(), size = at["size"].vector();
    const double angle = at["angle_deg"].angle();
    const Vec2 along(std::cos(angle), std::sin(angle));
    const Vec2 width = size.x() * along, height = size.y() * perp(along);
    return {corner, corner + width, corner + width + height, corner + height};
}

std::vector<Piece> arch(const Cursor& at) {
    const Vec2 center = at["center"].point();
    const double from = at["from_deg"].number(), sweep = at["to_deg"].number() - from, half = at["thickness"].number() / 2.0;
    const double inner = at["radius"].number() - half, outer = at["radius"].number() + half;
    const int count = static_cast<int>(at["count"].number());
    if (inner <= 0.0) at["thickness"].fault("must be below twice the radius");
    if (sweep <= 0.0 || sweep > 360.0) at["to_deg"].fault("must be above from_deg, by at most 360");
    if (count > 0 && sweep >= 180.0 * count) at["count"].fault("too few: a voussoir must span less than 180 degrees");
    // Neighbours take their common corners from the same two numbers, so that they touch exactly.
    const auto joint = [&](int i) {
        const double angle = radians(from + sweep * (sweep == 360.0 && i == count ? 0 : i) / count);
        return Vec2(std::cos(angle), std::sin(angle));
    };
    std::vector<Piece> pieces;
    for (int i = 0; i < count; ++i) {
        const Vec2 a = joint(i), b = joint(i + 1);
        pieces.push_back({"[" + std::to_string(i) + "]",
                          {center + inner * a, center + outer * a, center + outer * b, center + inner * b}});
    }
    return pieces;
}

std::vector<Piece> pieces_of(const Cursor& block) {
    const auto complete = [](const Cursor& shape, std::initializer_list<const char*> keys) {
        for (const char* key : keys)
            if (!shape[key].given()) return false;
        return true;
    };
    if (complete(block["arch"], {"center", "radius", "thickness", "count", "from_deg", "to_deg"}))
        return arch(block["arch"]);
    if (complete(block["rectangle"], {"corner", "size", "angle_deg"})) return {{"", rectangle(block["rectangle"])}};
    return {{"", read_outline_at(block["outline"])}};
}

std::vector<Copy> copies_along(const Cursor& repeat) {
    std::vector<Copy> copies;
    const Vec2 step = repeat["step"].vector(), stagger = repeat["stagger"].vector();
    for (int i = 0; i < static_cast<int>(repeat["count"].number()); ++i)
        copies.push_back({"[" + std::to_string(i) + "]", i * step + (i % 2 == 1 ? stagger : Vec2(Vec2::Zero()))});
    return copies;
}

std::vector<Copy> copies_of(const Cursor& block) {
    const Cursor repeat = block["repeat"];
    if (!repeat.given()) return {{}};
    if (repeat.is(Value::Kind::map)) return copies_along(repeat);
    const std::vector<Cursor> directions = repeat.items();
    if (directions.size() != 2) return {};
    std::vector<Copy> copies;
    const std::vector<Copy> second = copies_along(directions[1]);
    for (const Copy& a : copies_along(directions[0]))
        for (const Copy& b : second) copies.push_back({a.suffix + b.suffix, a.moved + b.moved});
    return copies;
}

Fixity convert_fixity(const Cursor& at) {
    if (at.is(Value::Kind::boolean)) return {at.yes(), at.yes(), at.yes()};
    const std::vector<double> each = at.numbers();
    return each.size() == 3 ? Fixity{each[0] != 0.0, each[1] != 0.0, each[2] != 0.0} : Fixity{};
}

// A direction that is driven is not held, so that `held: true` may stand for all the others.
void convert_driven(const Cursor& at, BlockSpec& block) {
    const auto take = [&](const char* key, bool& held, std::optional<TimeTable>& table) {
        if (!at[key].given()) return;
        table = at[key].time_table();
        held = false;
    };
    take("velocity_x", block.held.x, block.driven.velocity_x);
    take("velocity_y", block.held.y, block.driven.velocity_y);
    take("spin", block.held.rotation, block.driven.spin);
}

/// All that the copies have in common.
BlockSpec convert_common(const Cursor& at) {
    BlockSpec block;
    block.where = at.where();
    if (!at["material"].given()) at["material"].fault("is missing: name of a material");
    block.material = at["material"].name_of("material", at.reading().materials);
    block.held = convert_fixity(at["held"]);
    convert_driven(at["driven"], block);
    block.velocity = at["velocity"].vector();
    block.spin = at["spin"].number();
    return block;
}

}  // namespace

std::vector<BlockSpec> convert_blocks(const Cursor& blocks) {
    std::vector<BlockSpec> all;
    std::set<std::string> names;
    for (const std::string& region : blocks.reading().regions) names.insert(region);
    for (const Cursor& at : blocks.items()) {
        BlockSpec block = convert_common(at);
        const std::string name = at["name"].text();
        if (!names.insert(name).second) at["name"].fault("a block or region of this name is there already");
        const std::vector<Piece> pieces = pieces_of(at);
        for (const Copy& copy : copies_of(at))
            for (const Piece& piece : pieces) {
                block.name = name + copy.suffix + piece.suffix;
                block.outline = piece.outline;
                for (Vec2& corner : block.outline) corner += copy.moved;
                all.push_back(block);
            }
    }
    return all;
}

}  // namespace talus
