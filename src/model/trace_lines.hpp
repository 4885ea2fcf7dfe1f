// Mapped traces as the lines along which rock is cut. A map is never as clean as a joint set: ends that should meet miss
// each other, and the same place is drawn twice a micrometre apart.
#pragma once

#include "geometry/cut.hpp"
#include "scenario/scenario.hpp"

#include <vector>

namespace talus {

struct TraceLines {
    std::vector<CutLine> lines;
    int traces = 0;           // polylines with at least one segment left
    int corners_snapped = 0;  // corners moved onto another one
    int junctions = 0;        // corners set into a segment that passed by
    int tips_extended = 0;
};

/// Segments of a trace map, all with the given source. First corners closer than `snap` to one of the outline or to an
/// earlier one are moved onto it, and segments that pass a corner by less than `snap` are led through it. Then the free
/// tips of the traces, those at which no other trace passes, are extended along their last segments by `extend`; a trace
/// that ends at another one was mapped so and goes no further. Tips at which no trace passes are drawn out by `reach` at
/// least (m, also the least `snap`), so that a trace that ends on the outline meets it in spite of rounding.
TraceLines trace_lines(const TraceMapSpec& map, const Polygon& outline, double reach, int source);

/// Adds the segments of a polyline, drawn out by so much (m) at its tips; a closed one has no tips.
void add_polyline(std::vector<Vec2> points, double at_first, double at_last, int source, std::vector<CutLine>& lines);

}  // namespace talus
