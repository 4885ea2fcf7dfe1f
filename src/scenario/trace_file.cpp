#include "scenario/trace_file.hpp"

#include "core/errors.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <string_view>

namespace talus {
namespace {

using Json = nlohmann::json;
using Polyline = std::vector<Vec2>;

[[noreturn]] void refuse(const std::string& file, int line, const std::string& message) {
    throw InputError({Fault{{file, line}, {}, message}});
}

std::ifstream open(const std::string& file) {
    std::ifstream in(file);
    if (!in || in.peek() == std::ifstream::traits_type::eof()) refuse(file, 0, "cannot be read, or is empty");
    return in;
}

// ---- GeoJSON (RFC 7946) --------------------------------------------------------------------------------------------

Json parse(const std::string& file) {
    std::ifstream in = open(file);
    try {
        return Json::parse(in);
    } catch (const Json::exception& e) {
        refuse(file, 0, std::string("is not valid JSON: ") + e.what());
    }
}

/// Calls f(type, coordinates) for every geometry, however deep it lies in collections and features.
template <class F>
void for_geometries(const Json& item, F f) {
    if (!item.is_object()) return;  // a feature may have the geometry null
    if (item.contains("features")) {
        for (const Json& feature : item["features"]) for_geometries(feature, f);
    } else if (item.contains("geometries")) {
        for (const Json& geometry : item["geometries"]) for_geometries(geometry, f);
    } else if (item.contains("geometry")) {
        for_geometries(item["geometry"], f);
    } else if (item.contains("coordinates")) {
        f(item.value("type", std::string()), item["coordinates"]);
    }
}

Polyline polyline(const Json& positions) {
    Polyline points;
    for (const Json& p : positions) points.emplace_back(p.at(0).get<double>(), p.at(1).get<double>());
    return points;
}

/// Runs `f` on every geometry; coordinates of the wrong shape are faults of the file.
template <class F>
void read_geometries(const std::string& file, F f) {
    const Json json = parse(file);
    try {
        for_geometries(json, f);
    } catch (const Json::exception& e) {
        refuse(file, 0, std::string("is not valid GeoJSON: ") + e.what());
    }
}

std::vector<Polyline> traces_of_geojson(const std::string& file) {
    std::vector<Polyline> traces;
    read_geometries(file, [&](const std::string& type, const Json& coordinates) {
        if (type == "LineString") traces.push_back(polyline(coordinates));
        if (type == "MultiLineString")
            for (const Json& line : coordinates) traces.push_back(polyline(line));
    });
    return traces;
}

// ---- tables --------------------------------------------------------------------------------------------------------

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r\"");
    return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

std::vector<std::string_view> fields(std::string_view row) {
    std::vector<std::string_view> result;
    for (std::size_t at = 0; at <= row.size();) {
        const std::size_t comma = std::min(row.find(',', at), row.size());
        result.push_back(trimmed(row.substr(at, comma - at)));
        at = comma + 1;
    }
    return result;
}

std::vector<Polyline> traces_of_table(const std::string& file) {
    std::ifstream in = open(file);
    std::string row;
    int line = 1;
    std::getline(in, row);
    if (fields(row) != std::vector<std::string_view>{"id", "x", "y"}) refuse(file, line, "the first line must be id,x,y");

    std::vector<Polyline> traces;
    std::map<std::string, std::size_t, std::less<>> place;  // of an id among the traces
    while (++line, std::getline(in, row)) {
        if (trimmed(row).empty()) continue;
        const auto columns = fields(row);
        if (columns.size() != 3) refuse(file, line, "needs three columns: id,x,y");
        const auto number = [&](std::string_view text) {
            double value = 0.0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
                refuse(file, line, "'" + std::string(text) + "' is not a number");
            return value;
        };
        const auto [it, is_new] = place.try_emplace(std::string(columns[0]), traces.size());
        if (is_new) traces.emplace_back();
        traces[it->second].emplace_back(number(columns[1]), number(columns[2]));
    }
    return traces;
}

double twice_area(const Polygon& polygon) {
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < polygon.size(); ++i) sum += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    return sum;
}

}  // namespace

std::vector<Polyline> read_traces(const std::string& file) {
    std::vector<Polyline> traces = file.ends_with(".csv") ? traces_of_table(file) : traces_of_geojson(file);
    std::erase_if(traces, [](const Polyline& trace) { return trace.size() < 2; });
    if (traces.empty()) refuse(file, 0, "has no lines of two points or more");
    return traces;
}

Polygon read_outline(const std::string& file) {
    std::vector<Polygon> polygons;
    read_geometries(file, [&](const std::string& type, const Json& coordinates) {
        if (type == "Polygon") polygons.push_back(polyline(coordinates.at(0)));
        if (type == "MultiPolygon")
            for (const Json& polygon : coordinates) polygons.push_back(polyline(polygon.at(0)));
    });
    if (polygons.size() != 1) refuse(file, 0, "needs exactly one polygon, has " + std::to_string(polygons.size()));
    Polygon& outline = polygons[0];
    if (outline.size() > 1 && outline.front() == outline.back()) outline.pop_back();  // GeoJSON rings are closed
    if (outline.size() < 3) refuse(file, 0, "the polygon has fewer than three corners");
    if (twice_area(outline) < 0.0) std::reverse(outline.begin(), outline.end());
    return outline;
}

}  // namespace talus
