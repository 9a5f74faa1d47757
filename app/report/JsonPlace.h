#pragma once

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace app {

/// One value of a JSON file and the way to it, read with a check: what is missing, misspelt, of another kind
/// or out of its range is refused with std::runtime_error, one sentence that names file, place, cause and
/// remedy. Keeps a reference to the value.
class JsonPlace {
  public:
    /// A whole document. `format`: the file that describes it, named where something is missing.
    JsonPlace(const nlohmann::json& document, std::string file, std::string format)
        : JsonPlace(document, std::move(file), std::move(format), "") {}

    [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const;
    JsonPlace at(const std::string& key) const;
    bool has(const std::string& key) const { return value_.is_object() && value_.contains(key); }
    /// Refuses every name but these: a misspelt one would otherwise be silently without effect.
    void only(const std::set<std::string>& names) const;
    std::vector<JsonPlace> items() const;
    double number(double low, double high) const;
    int whole(int low, int high) const;
    std::string text() const;
    glm::dvec3 vector(double low = -1e6, double high = 1e6) const;
    glm::vec3 share() const { return glm::vec3(vector(0, 1)); }

  private:
    JsonPlace(const nlohmann::json& value, std::string file, std::string format, std::string path)
        : value_(value), file_(std::move(file)), format_(std::move(format)), path_(std::move(path)) {}
    void object() const;

    const nlohmann::json& value_;
    std::string file_, format_, path_;
};

/// A file's text as a document; `name` is told where it is none.
nlohmann::json parseJson(const std::string& text, const std::string& name);

}  // namespace app
