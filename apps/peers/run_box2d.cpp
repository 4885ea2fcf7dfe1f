// A scene of docs/runners.md with Box2D 2.4:  talus_run_box2d SCENE.json RESULT.json
// Settings: `rate` (steps per s), `iterations` (of velocities), `position_iterations`, `slop` (m: overlap that the library
// leaves alone; the world is scaled so that its own becomes this), `restitution`. Bonded faces become weld joints.
#include <box2d/box2d.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <set>
#include <stdexcept>
#include <vector>

namespace {

using nlohmann::json;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double friction_of(const json& scene) {
    std::set<double> found;
    for (const json& contact : scene["contacts"])
        if (!contact["bonded"].get<bool>()) found.insert(contact["friction"].get<double>());
    if (found.size() > 1) throw std::runtime_error("one friction for all contacts, not several");
    return found.empty() ? scene["friction"].get<double>() : *found.begin();
}

class World {
public:
    explicit World(const json& scene)
        : given_(scene["settings"]),
          scale_(static_cast<float>(b2_linearSlop / given_.value("slop", 0.5e-3))),
          friction_(static_cast<float>(friction_of(scene))),
          iterations_(given_.value("iterations", 8)),
          position_iterations_(given_.value("position_iterations", 3)),
          world_(b2Vec2_zero) {
        world_.SetAllowSleeping(false);
        for (const json& block : scene["blocks"]) add(block);
        for (const json& contact : scene["contacts"])
            if (contact["bonded"].get<bool>()) weld(contact);
    }

    void pull(double x, double y) { world_.SetGravity(scaled(x, y)); }
    void step(double dt) { world_.Step(static_cast<float>(dt), iterations_, position_iterations_); }

    /// Positions in m, angles in rad, turned since the start.
    void look(json& position, json& angle) const {
        json places = json::array(), turns = json::array();
        for (std::size_t b = 0; b < bodies_.size(); ++b) {
            const b2Vec2 moved = bodies_[b]->GetPosition();
            places.push_back({static_cast<double>(moved.x) / scale_, static_cast<double>(moved.y) / scale_});
            turns.push_back(bodies_[b]->GetAngle());
        }
        position.push_back(places);
        angle.push_back(turns);
    }

private:
    b2Vec2 scaled(double x, double y) const { return {static_cast<float>(x) * scale_, static_cast<float>(y) * scale_}; }
    b2Vec2 scaled(const json& point) const { return scaled(point[0].get<double>(), point[1].get<double>()); }

    void add(const json& block) {
        b2BodyDef described;
        described.type = block["held"].get<bool>() ? b2_staticBody : b2_dynamicBody;
        described.position = scaled(block["position"]);
        described.linearVelocity = scaled(block["velocity"]);
        b2Body* body = world_.CreateBody(&described);
        for (const json& part : block["parts"]) add_shapes(*body, part);
        b2MassData mass{static_cast<float>(block["mass"].get<double>()), b2Vec2_zero,
                        static_cast<float>(block["inertia"].get<double>()) * scale_ * scale_};
        body->SetMassData(&mass);
        bodies_.push_back(body);
    }

    // Shapes have at most eight corners: larger parts become a fan of them. The library rounds shapes by a radius and lets
    // them overlap by its slop: half a slop for each, and blocks that touch are at rest where they are.
    void add_shapes(b2Body& body, const json& part) {
        std::vector<b2Vec2> corner;
        for (const json& point : part) corner.push_back(scaled(point));
        for (std::size_t k = 1; k + 1 < corner.size(); k += b2_maxPolygonVertices - 2) {
            std::vector<b2Vec2> piece{corner.front()};
            piece.insert(
                piece.end(), corner.begin() + static_cast<std::ptrdiff_t>(k),
                corner.begin() + static_cast<std::ptrdiff_t>(std::min(k + b2_maxPolygonVertices - 1, corner.size())));
            b2PolygonShape shape;
            shape.Set(piece.data(), static_cast<int32>(piece.size()));
            shape.m_radius = 0.5f * b2_linearSlop;
            b2FixtureDef fixture;
            fixture.shape = &shape;
            fixture.friction = friction_;
            fixture.restitution = given_.value("restitution", 0.0f);
            fixture.restitutionThreshold = 0.0f;
            body.CreateFixture(&fixture);
        }
    }

    void weld(const json& contact) {
        b2Body* a = bodies_.at(contact["a"].get<std::size_t>());
        b2Body* b = bodies_.at(contact["b"].get<std::size_t>());
        if (a->GetType() == b2_staticBody && b->GetType() == b2_staticBody) return;
        b2WeldJointDef described;
        described.Initialize(a, b, 0.5f * (scaled(contact["from"]) + scaled(contact["to"])));
        world_.CreateJoint(&described);
    }

    json given_;
    float scale_;  // units of the library in a metre
    float friction_;
    int iterations_, position_iterations_;
    b2World world_;
    std::vector<b2Body*> bodies_;
};

/// m/s2, linear between the times of a table.
class Gravity {
public:
    explicit Gravity(const json& table)
        : time_(table["time"].get<std::vector<double>>()),
          x_(table["x"].get<std::vector<double>>()),
          y_(table["y"].get<std::vector<double>>()) {}
    bool steady() const { return time_.size() == 1; }
    void pull(World& world, double t) const {
        const auto after = static_cast<std::size_t>(std::upper_bound(time_.begin(), time_.end(), t) - time_.begin());
        if (after == 0) return world.pull(x_.front(), y_.front());
        if (after == time_.size()) return world.pull(x_.back(), y_.back());
        const std::size_t k = after - 1;
        const double share = (t - time_[k]) / (time_[after] - time_[k]);
        world.pull(x_[k] + share * (x_[after] - x_[k]), y_[k] + share * (y_[after] - y_[k]));
    }

private:
    std::vector<double> time_, x_, y_;  // s, m/s2, m/s2
};

json compute(const json& scene) {
    World world(scene);
    const Gravity gravity(scene["gravity"]);
    const double end = scene["end"].get<double>();
    const auto count = std::max<long>(1, std::lround(std::ceil(end * scene["settings"].value("rate", 240.0) - 1e-9)));
    const long frames = std::min<long>(scene["frames"].get<long>(), count);
    const double dt = end / static_cast<double>(count);
    json result{{"time", json::array({0.0})}, {"position", json::array()}, {"angle", json::array()}};
    world.look(result["position"], result["angle"]);
    gravity.pull(world, 0.0);
    double cpu = 0.0, begun = cpu_seconds();
    for (long k = 1, frame = 1; k <= count; ++k) {
        if (!gravity.steady()) gravity.pull(world, (static_cast<double>(k) - 0.5) * dt);
        world.step(dt);
        if (k * frames < frame * count) continue;
        cpu += cpu_seconds() - begun;
        result["time"].push_back(static_cast<double>(k) * dt);
        world.look(result["position"], result["angle"]);
        ++frame;
        begun = cpu_seconds();
    }
    result["cpu_time"] = cpu;
    return result;
}

}  // namespace

int main(int count, char** words) try {
    if (count != 3) throw std::runtime_error("usage: talus_run_box2d SCENE.json RESULT.json");
    std::ifstream in(words[1]);
    const json result = compute(json::parse(in));
    std::ofstream(words[2]) << result;
    return 0;
} catch (const std::exception& error) {
    std::cerr << "talus_run_box2d: " << error.what() << '\n';
    return 2;
}
