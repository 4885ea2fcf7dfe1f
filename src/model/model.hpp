// What the scene is: constant while a stage runs. Arrays are indexed by dense ids; shapes stand at the declarations.
//   nb blocks, np convex parts (one per convex block, more for concave ones), nc corners of parts, nj joints, nf joint faces
#pragma once

#include "core/time_table.hpp"
#include "core/types.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace talus {

struct Blocks {
    std::vector<int> first_part;        // [nb+1] parts of block b are [first_part[b], first_part[b+1])
    std::vector<double> mass, inertia;  // [nb] kg, kg m2 about the centroid
    std::vector<double> area;           // [nb] m2
    std::vector<double> radius;         // [nb] m, of the farthest corner from the centroid
    std::vector<Vec2> inv_mass;         // [nb] 1/kg along x and y; 0 = held or driven along that axis
    std::vector<double> inv_inertia;    // [nb] 1/(kg m2); 0 = rotation held or driven
    std::vector<Vec2> start;            // [nb] m, centroid when the scene was built
    std::vector<int> material;          // [nb]
    std::vector<std::string> name;      // [nb] empty for blocks cut from rock
    std::vector<int> region;            // [nb] index into Model::region_names, -1 = none
    int size() const { return static_cast<int>(mass.size()); }
    bool held(BlockId b) const { return inv_mass[b].x() == 0.0 && inv_mass[b].y() == 0.0 && inv_inertia[b] == 0.0; }
};

struct Parts {
    std::vector<int> block;         // [np]
    std::vector<int> first_corner;  // [np+1]
    std::vector<double> thickness;  // [np] m, smallest width of the part; of a tiny ear, that of its block
    int size() const { return static_cast<int>(block.size()); }
};

struct Corners {                 // edge k of a part runs from corner k to the next one of the part, counter-clockwise
    std::vector<Vec2> arm;       // [nc] m, from the centroid of the block, unrotated
    std::vector<Vec2> normal;    // [nc] outward unit normal of the edge, unrotated
    std::vector<double> offset;  // [nc] m, normal . arm: distance of the edge line from the centroid
    std::vector<double> length;  // [nc] m, of the edge
    std::vector<std::uint8_t> internal;  // [nc] 1 = edge between two parts of one block
    std::vector<double> cut;  // [nc] m, where the arc of a rounded corner leaves its edges; empty = corners are sharp
    int size() const { return static_cast<int>(arm.size()); }
};

/// Properties of a joint, ready for the law. Stiffness in Pa/m, strength in Pa, angles as tangents.
struct JointLaw {
    double kn = 0.0, ks = 0.0;
    double tan_friction = 0.0, cohesion = 0.0, tension = 0.0;
    double tan_friction_residual = 0.0, cohesion_residual = 0.0;
    double tan_dilation = 0.0;
    double dilation_cutoff_slip = std::numeric_limits<double>::infinity();  // m
    double restitution = 0.0;  // of the speed of approach, in impacts of rigid blocks
    bool weakens = false;      // strength drops to its residual value at the first slip
};

struct Joint : JointLaw {
    int cells = 2;  // bond cells per face
    std::string name;
};

/// A stretch along which two parts touched when the scene was built, with the stress it carried then. One per pair of parts
/// at most, for two convex polygons share at most one line. Only faces whose joint can pull (tension, cohesion) or that were
/// under stress are kept: all others are found like any contact.
struct alignas(64) JointFace {  // a cache line: read at every step
    PartId part_a, part_b;      // a < b; the list of faces is sorted by them
    int edge_a, edge_b;         // corner index (global) where the edge starts
    int joint;
    int first_cell;         // cells are [first_cell, first_cell + joint.cells) of Contacts::broken
    bool bonded;            // cells can carry tension or cohesion
    double s0, s1;          // m, ends of the face measured along edge_a from its first corner
    double sigma0, sigma1;  // Pa, normal stress at s0 and s1 when built
};

struct DrivenBlock {  // prescribed velocities of the axes that are driven; other axes stay as they are
    BlockId block;
    bool x = false, y = false, rotation = false;
    TimeTable velocity_x, velocity_y, spin;
};

struct Load {  // force that follows a material point of a block
    BlockId block;
    Vec2 arm;                            // m, unrotated, from the centroid
    TimeTable force_x, force_y, moment;  // N, N, N m
};

struct Model {
    Vec2 origin = Vec2::Zero();  // m, add to every coordinate to get the user's
    Blocks blocks;
    Parts parts;
    Corners corners;
    std::vector<Joint> joints;  // [nj]
    std::vector<std::string> material_names, region_names;
    int default_joint = 0;
    std::vector<int> joint_of_materials;                // [nm*nm] joint of a pair of materials
    std::vector<std::pair<Pair, int>> joint_of_blocks;  // sorted: named block pairs and the joint between them
    std::vector<std::pair<Pair, int>> joint_of_faces;   // sorted: part pairs that touch along a joint set with its own joint
    std::vector<JointFace> faces;                       // [nf]
    std::vector<DrivenBlock> driven;
    std::vector<Load> loads;
    int boundary_loads = 0;          // the first so many loads carry the in-situ stress on free sides; stages keep them
    TimeTable gravity_x, gravity_y;  // m/s2, gravity and body acceleration together
    double local_damping = 0.0;      // Cundall's alpha
    double contact_damping = 0.0;    // s
    double release_time = 0.0;       // s over which the forces of deleted blocks fade in this stage
    bool face_path = true;
    double rounding_length = 0.0;   // m, of corners that touch at points, see rounded_corners.hpp; 0 = they are sharp
    Vec2 box_axis = Vec2::UnitX();  // unit, the first axis along which boxes of parts are taken, see box_axes.hpp

    int cells() const { return faces.empty() ? 0 : faces.back().first_cell + joints[faces.back().joint].cells; }
    /// Joint acting between two parts: named blocks, then the joint set that cut them, then materials, then the default.
    int joint_between(PartId a, PartId b) const;
};

}  // namespace talus
