#include "geometry/cut.hpp"
#include "geometry/planar_map.hpp"
#include "geometry/polygon.hpp"

#include <CGAL/Arr_curve_data_traits_2.h>
#include <CGAL/Arr_extended_dcel.h>
#include <CGAL/Arr_segment_traits_2.h>
#include <CGAL/Arrangement_2.h>
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace talus {
namespace {

// ---- arrangement: outline, holes, regions and lines together -------------------------------------------------------

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;

struct Tag {  // what runs along an edge
    int source;
    std::vector<int> polygons;  // whose boundary it is; one met twice cancels, as crossing it twice does

    bool operator==(const Tag& other) const { return source == other.source && polygons == other.polygons; }
};

struct JoinTags {  // of lines that lie on each other
    Tag operator()(const Tag& a, const Tag& b) const {
        Tag both{a.source < 0 ? b.source : b.source < 0 ? a.source : std::min(a.source, b.source), a.polygons};
        both.polygons.insert(both.polygons.end(), b.polygons.begin(), b.polygons.end());
        return both;
    }
};

using Traits = CGAL::Arr_curve_data_traits_2<CGAL::Arr_segment_traits_2<Exact>, Tag, JoinTags>;
using Arrangement = CGAL::Arrangement_2<Traits, CGAL::Arr_extended_dcel<Traits, int, int, int>>;

/// The polygons of a cut in one list: the outline, then the holes, then the regions. A Tag holds places in it.
struct Polygons {
    std::vector<const Polygon*> all;
    int holes_end;

    explicit Polygons(const CutInput& input) : all{&input.outline}, holes_end(1 + static_cast<int>(input.holes.size())) {
        for (const Polygon& hole : input.holes) all.push_back(&hole);
        for (const CutRegion& region : input.regions) all.push_back(&region.outline);
    }
};

Arrangement arrange(const CutInput& input, const Polygons& polygons) {
    std::vector<Traits::Curve_2> curves;
    const auto add = [&](const Vec2& from, const Vec2& to, Tag tag) {
        if (from == to) return;
        const CGAL::Segment_2<Exact> segment({from.x(), from.y()}, {to.x(), to.y()});
        curves.emplace_back(segment, std::move(tag));
    };
    for (std::size_t p = 0; p < polygons.all.size(); ++p) {
        const Polygon& polygon = *polygons.all[p];
        for (std::size_t i = 0; i < polygon.size(); ++i)
            add(polygon[i], polygon[(i + 1) % polygon.size()], {-1, {static_cast<int>(p)}});
    }
    const Box box = bounds(input.outline);
    for (const CutLine& line : input.lines)
        if (bounds(std::array{line.from, line.to}).overlaps(box)) add(line.from, line.to, {line.source, {}});
    Arrangement arrangement;
    CGAL::insert(arrangement, curves.begin(), curves.end());
    return arrangement;
}

/// Calls f(halfedge) for the whole boundary of a face: outside, islands and edges that run into it.
template <class F>
void for_boundary(Arrangement::Face_handle face, F f) {
    const auto around = [&](Arrangement::Ccb_halfedge_circulator first) {
        auto h = first;
        do f(Arrangement::Halfedge_handle(h));
        while (++h != first);
    };
    if (face->has_outer_ccb()) around(face->outer_ccb());
    for (auto island = face->inner_ccbs_begin(); island != face->inner_ccbs_end(); ++island) around(*island);
}

/// Walks from the unbounded face over all others, notes which polygons each one lies in, and numbers the faces of the rock
/// in their data (-1: outside). Exact, because only topology is used. Returns the region of each numbered face.
std::vector<int> number_faces(Arrangement& arrangement, const CutInput& input, const Polygons& polygons) {
    std::vector<int> regions;
    constexpr int unseen = -2;
    for (auto face = arrangement.faces_begin(); face != arrangement.faces_end(); ++face) face->set_data(unseen);

    const auto number = [&](const std::vector<bool>& in) {
        if (!in[0] || std::find(in.begin() + 1, in.begin() + polygons.holes_end, true) != in.begin() + polygons.holes_end)
            return -1;
        int region = -1;
        for (std::size_t r = 0; r < input.regions.size(); ++r)
            if (in[polygons.holes_end + r]) region = input.regions[r].id;
        regions.push_back(region);
        return static_cast<int>(regions.size()) - 1;
    };

    std::vector<std::pair<Arrangement::Face_handle, std::vector<bool>>> waiting;
    waiting.emplace_back(arrangement.unbounded_face(), std::vector<bool>(polygons.all.size(), false));
    arrangement.unbounded_face()->set_data(-1);
    while (!waiting.empty()) {
        const auto [face, in] = std::move(waiting.back());
        waiting.pop_back();
        for_boundary(face, [&](Arrangement::Halfedge_handle h) {
            const auto other = h->twin()->face();
            if (other->data() != unseen) return;
            std::vector<bool> in_other = in;
            for (const int p : h->curve().data().polygons) in_other[p] = !in_other[p];
            other->set_data(number(in_other));
            waiting.emplace_back(other, std::move(in_other));
        });
    }
    return regions;
}

/// Nearest double, or one of its neighbours. The filter of the lazy numbers is wide where lines cross at a small angle:
/// there the exact value is computed.
double to_double(const Exact::FT& x) {
    const auto [low, high] = CGAL::to_interval(x);
    const double middle = low + (high - low) / 2.0;
    if (high - low <= 2.0 * std::numeric_limits<double>::epsilon() * std::abs(middle)) return middle;
    return CGAL::to_double(x.exact());
}

PlanarMap flatten(Arrangement& arrangement, std::vector<int> regions, CutReport& report) {
    PlanarMap map;
    map.region = std::move(regions);
    for (auto v = arrangement.vertices_begin(); v != arrangement.vertices_end(); ++v) {
        v->set_data(-1);
        if (v->degree() == 1 && v->incident_halfedges()->face()->data() >= 0) ++report.dangling;
    }
    const auto vertex = [&](Arrangement::Vertex_handle v) {
        if (v->data() < 0) {
            v->set_data(static_cast<int>(map.point.size()));
            map.point.emplace_back(to_double(v->point().x()), to_double(v->point().y()));
        }
        return v->data();
    };

    std::vector<Arrangement::Halfedge_handle> kept;
    const auto add = [&](Arrangement::Halfedge_handle h) {
        h->set_data(static_cast<int>(map.half.size()));
        kept.push_back(h);
        map.half.push_back({vertex(h->source()), -1, h->face()->data(), h->curve().data().source});
    };
    for (auto edge = arrangement.edges_begin(); edge != arrangement.edges_end(); ++edge) {
        if (edge->face()->data() < 0 && edge->twin()->face()->data() < 0) continue;
        add(edge);
        add(edge->twin());
    }
    for (std::size_t h = 0; h < kept.size(); ++h)
        if (map.half[h].face >= 0) map.half[h].next = kept[h]->next()->data();
    return map;
}

// ---- convex parts --------------------------------------------------------------------------------------------------

using Plain = CGAL::Exact_predicates_inexact_constructions_kernel;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Plain, CGAL::Triangulation_face_base_with_info_2<int, Plain>>;
using TriangleMap = CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<Plain>, FaceBase>;
// Rounding may have made the outlines of thin blocks cross: with this tag the crossing becomes a corner of the
// triangulation.
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Plain, TriangleMap, CGAL::Exact_predicates_tag>;

void constrain(Triangulation& triangulation, const Polygon& polygon) {
    std::vector<Triangulation::Vertex_handle> vertices;
    for (const Vec2& p : polygon) vertices.push_back(triangulation.insert({p.x(), p.y()}));
    for (std::size_t i = 0; i < vertices.size(); ++i)
        triangulation.insert_constraint(vertices[i], vertices[(i + 1) % vertices.size()]);
}

/// Triangles inside the polygon and outside its holes, numbered in their info (-1: outside). Each is judged by its centre,
/// for rounding may lay two stretches of an outline on each other, and then counting the edges crossed goes wrong.
std::vector<Triangulation::Face_handle> inner_triangles(Triangulation& triangulation, const Polygon& outline,
                                                        const std::vector<Polygon>& holes) {
    for (const auto face : triangulation.all_face_handles()) face->info() = -1;
    std::vector<Triangulation::Face_handle> inner;
    for (const auto face : triangulation.finite_face_handles()) {
        const auto centre = CGAL::centroid(triangulation.triangle(face));
        const auto around = [c = Vec2(centre.x(), centre.y())](const Polygon& polygon) { return contains(polygon, c); };
        if (!around(outline) || std::any_of(holes.begin(), holes.end(), around)) continue;
        face->info() = static_cast<int>(inner.size());
        inner.push_back(face);
    }
    return inner;
}

/// Triangles joined to convex parts over every diagonal that is not needed, longest first (Hertel & Mehlhorn 1983).
class Parts {
public:
    explicit Parts(const std::vector<Triangulation::Face_handle>& triangles) {
        for (const auto& face : triangles)
            for (int i = 0; i < 3; ++i) {  // CGAL numbers the edge of a triangle by the corner opposite to it
                const int first = 3 * face->info();
                const auto& p = face->vertex(Triangulation::ccw(i))->point();
                const auto other = face->neighbor(i);
                const bool diagonal = !face->is_constrained(i) && other->info() >= 0;
                edges_.push_back({{p.x(), p.y()},
                                  first + (i + 1) % 3,
                                  first + (i + 2) % 3,
                                  diagonal ? 3 * other->info() + other->index(face) : -1});
            }
        Polygon corners;
        for (const Edge& e : edges_) corners.push_back(e.from);
        const Box box = bounds(corners);
        rounding_ = rounding(corners);
        thin_ = std::max(rounding_, 1e-8 * std::max(box.xmax - box.xmin, box.ymax - box.ymin));
    }

    std::vector<Polygon> join() {
        std::vector<int> diagonals;
        for (int e = 0; e < static_cast<int>(edges_.size()); ++e)
            if (edges_[e].twin > e) diagonals.push_back(e);
        std::stable_sort(diagonals.begin(), diagonals.end(), [&](int a, int b) { return length(a) > length(b); });
        for (const int d : diagonals)
            if (bend(d) > rounding_) remove(d);
        // Corners in one line, not next to each other (the ends of two teeth), leave a triangle without thickness. It goes
        // to a neighbour even if that then has a straight corner. Where it cannot (a neck), it is left out below: a part
        // without thickness would stop every time step.
        for (const int d : diagonals)
            if (edges_[d].twin >= 0 && (is_thin(d) || is_thin(edges_[d].twin)) && bend(d) > -thin_) remove(d);
        return loops();
    }

private:
    struct Edge {
        Vec2 from;
        int next, before, twin;  // twin: the same diagonal in the other triangle, -1 on the boundary, -2 once removed
    };

    double length(int e) const { return (edges_[edges_[e].next].from - edges_[e].from).norm(); }

    /// How far the sharper of the two corners would stand out that are left when a diagonal goes, m; negative: inwards.
    double bend(int d) const {
        const int t = edges_[d].twin;
        return std::min(bend(edges_[d].before, edges_[t].next), bend(edges_[t].before, edges_[d].next));
    }
    double bend(int in, int out) const {
        const Vec2 a = edges_[out].from - edges_[in].from;
        const Vec2 b = edges_[edges_[out].next].from - edges_[out].from;
        return cross(a, b) / std::max((a + b).norm(), rounding_);
    }

    Polygon loop(int first) const {
        Polygon polygon;
        int e = first;
        do polygon.push_back(edges_[e].from);
        while ((e = edges_[e].next) != first);
        return polygon;
    }
    bool is_thin(int e) const { return smallest_width(loop(e)) < thin_; }

    void connect(int in, int out) { edges_[in].next = out, edges_[out].before = in; }

    void remove(int d) {
        const int t = edges_[d].twin;
        connect(edges_[d].before, edges_[t].next);
        connect(edges_[t].before, edges_[d].next);
        edges_[d].twin = edges_[t].twin = -2;
    }

    std::vector<Polygon> loops() const {
        std::vector<Polygon> parts;
        std::vector<char> seen(edges_.size(), false);
        for (int first = 0; first < static_cast<int>(edges_.size()); ++first) {
            if (seen[first] || edges_[first].twin == -2) continue;
            parts.push_back(loop(first));
            for (int e = first; !seen[e]; e = edges_[e].next) seen[e] = true;
        }
        const auto thin = [&](const Polygon& part) { return smallest_width(part) < thin_; };
        if (!std::all_of(parts.begin(), parts.end(), thin)) std::erase_if(parts, thin);
        return parts;
    }

    std::vector<Edge> edges_;
    double rounding_;  // m, below which a corner is straight
    double thin_;      // m, below which a part is nothing a block could be made of
};

}  // namespace

CutResult cut(const CutInput& input) {
    CutReport report;
    const Polygons polygons(input);
    Arrangement arrangement = arrange(input, polygons);
    PlanarMap map = flatten(arrangement, number_faces(arrangement, input, polygons), report);
    arrangement.clear();  // the exact numbers are large and no longer needed
    const std::vector<int> of = merge_slivers(map, input, report);
    return read_blocks(map, of, std::move(report));
}

std::vector<Polygon> convex_parts(const Polygon& outline, const std::vector<Polygon>& holes) {
    if (holes.empty() && is_convex(outline)) return {outline};
    Triangulation triangulation;
    constrain(triangulation, outline);
    for (const Polygon& hole : holes) constrain(triangulation, hole);
    return Parts(inner_triangles(triangulation, outline, holes)).join();
}

}  // namespace talus
