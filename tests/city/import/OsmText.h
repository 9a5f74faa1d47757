#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace city {

/// Writes small .osm files in metres around 60 degrees north, 25 degrees east, for tests.
class OsmText {
  public:
    using Tags = std::vector<std::pair<std::string, std::string>>;

    /// The file's bounds: a square of this half side, metres; without, the file has none.
    void bounds(double half) {
        bounds_ = "<bounds minlat='" + latitude(-half) + "' maxlat='" + latitude(half) + "' minlon='" +
                  longitude(-half) + "' maxlon='" + longitude(half) + "'/>\n";
    }
    long node(double x, double y, const Tags& tags = {}) {
        body_ += "<node id='" + std::to_string(++last_) + "' version='1' lat='" + latitude(y) + "' lon='" +
                 longitude(x) + "'>" + text(tags) + "</node>\n";
        return last_;
    }
    long way(const std::vector<long>& nodes, const Tags& tags) {
        body_ += "<way id='" + std::to_string(++last_) + "' version='1'>";
        for (const long node : nodes) body_ += "<nd ref='" + std::to_string(node) + "'/>";
        body_ += text(tags) + "</way>\n";
        return last_;
    }
    long line(const std::vector<std::pair<double, double>>& points, const Tags& tags) {
        std::vector<long> nodes;
        nodes.reserve(points.size());
        for (const auto& [x, y] : points) nodes.push_back(node(x, y));
        return way(nodes, tags);
    }
    long box(double x0, double y0, double x1, double y1, const Tags& tags) {
        const long a = node(x0, y0);
        const long b = node(x1, y0);
        const long c = node(x1, y1);
        const long d = node(x0, y1);
        return way({a, b, c, d, a}, tags);
    }
    long multipolygon(const std::vector<std::pair<long, std::string>>& members, const Tags& tags) {
        body_ += "<relation id='" + std::to_string(++last_) + "' version='1'>";
        for (const auto& [way, role] : members)
            body_ += "<member type='way' ref='" + std::to_string(way) + "' role='" + role + "'/>";
        body_ += "<tag k='type' v='multipolygon'/>" + text(tags) + "</relation>\n";
        return last_;
    }
    std::string str() const {
        return "<?xml version='1.0' encoding='UTF-8'?>\n<osm version='0.6' generator='test'>\n" + bounds_ +
               body_ + "</osm>\n";
    }
    std::filesystem::path save(const std::string& name) const { return saveText(name, str()); }

    static std::filesystem::path saveText(const std::string& name, const std::string& content) {
        const std::filesystem::path folder = std::filesystem::path(MIRRORSTREET_TEST_OUT) / "osm";
        std::filesystem::create_directories(folder);
        std::ofstream(folder / name, std::ios::binary) << content;
        return folder / name;
    }

  private:
    // On the ellipsoid at 60 degrees: metres to a degree.
    static std::string latitude(double y) { return std::to_string(60 + y / 111412.0); }
    static std::string longitude(double x) { return std::to_string(25 + x / 55800.0); }
    static std::string text(const Tags& tags) {
        std::string out;
        for (const auto& [key, value] : tags)
            out.append("<tag k='").append(key).append("' v='").append(value).append("'/>");
        return out;
    }
    std::string bounds_;
    std::string body_;
    long last_ = 0;
};

}  // namespace city
