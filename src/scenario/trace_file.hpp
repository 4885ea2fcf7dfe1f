// Mapped traces and outlines from files of geographic information systems. Coordinates are returned as they stand in the
// file.
#pragma once

#include "core/types.hpp"

#include <string>
#include <vector>

namespace talus {

/// Polylines of every LineString and MultiLineString of a GeoJSON file (other geometries are passed over), or of a table
/// `id,x,y` with a header line if the name ends in .csv: rows of equal id form one polyline, in the order of the rows.
/// Throws InputError naming the file and what is wrong: cannot be read, no valid JSON, a number that is none, no lines.
std::vector<std::vector<Vec2>> read_traces(const std::string& file);

/// Outer ring of the one Polygon of a GeoJSON file, counter-clockwise, not closed. Throws InputError like read_traces, also
/// if there are several polygons.
Polygon read_outline(const std::string& file);

}  // namespace talus
