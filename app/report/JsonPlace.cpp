#include "app/report/JsonPlace.h"

#include <sstream>
#include <stdexcept>

namespace app {

void JsonPlace::refuse(const std::string& what, const std::string& remedy) const {
    throw std::runtime_error(file_ + (path_.empty() ? "" : ", " + path_) + ": " + what + "; " + remedy + ".");
}

JsonPlace JsonPlace::at(const std::string& key) const {
    object();
    if (!value_.contains(key)) refuse("'" + key + "' is missing", "add it, see " + format_);
    return {value_.at(key), file_, format_, path_.empty() ? key : path_ + "." + key};
}

void JsonPlace::only(const std::set<std::string>& names) const {
    object();
    for (const auto& [key, v] : value_.items()) {
        if (names.contains(key)) continue;
        std::string list;
        for (const std::string& n : names) list += (list.empty() ? "" : ", ") + n;
        refuse("there is no '" + key + "' here", "use only " + list);
    }
}

std::vector<JsonPlace> JsonPlace::items() const {
    if (!value_.is_array()) refuse("is not a list", "write [ ... ]");
    std::vector<JsonPlace> all;
    for (std::size_t i = 0; i < value_.size(); ++i)
        all.push_back({value_[i], file_, format_, path_ + "[" + std::to_string(i) + "]"});
    return all;
}

double JsonPlace::number(double low, double high) const {
    if (!value_.is_number()) refuse("is not a number", "write a plain finite number");
    const double v = value_.get<double>();
    if (!(v >= low && v <= high)) {
        std::ostringstream range;
        range << v << " lies outside " << low << " .. " << high;
        refuse(range.str(), "choose a value within it");
    }
    return v;
}

int JsonPlace::whole(int low, int high) const {
    if (!value_.is_number_integer()) refuse("is not a whole number", "write one, without a point");
    return static_cast<int>(number(low, high));
}

std::string JsonPlace::text() const {
    if (!value_.is_string()) refuse("is not a text", "put it in quotes");
    return value_.get<std::string>();
}

glm::dvec3 JsonPlace::vector(double low, double high) const {
    const std::vector<JsonPlace> three = items();
    if (three.size() != 3)
        refuse("has " + std::to_string(three.size()) + " numbers", "write three, [x, y, z]");
    return {three[0].number(low, high), three[1].number(low, high), three[2].number(low, high)};
}

void JsonPlace::object() const {
    if (!value_.is_object()) refuse("is not an object", "write { ... }");
}

nlohmann::json parseJson(const std::string& text, const std::string& name) {
    try {
        return nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& e) {
        throw std::runtime_error(name + ": is not JSON (" + e.what() + "); correct it there.");
    }
}

}  // namespace app
