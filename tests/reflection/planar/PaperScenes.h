#pragma once

#include <vector>

#include "reflection/planar/ReflectionTree.h"

/// The least geometry that has the counts of Nielsen & Christensen's Table 1.
struct CountedScene {
    std::vector<reflection::Mirror> mirrors;
    std::vector<reflection::CurvedReflector> curved;
    reflection::TreeView view;
    int depth = 2;

    void addMirror(std::vector<glm::dvec3> corners) {
        const auto made = reflection::MirrorPlane::make(corners);
        mirrors.push_back({mirrors.size(), made.mirror, reflection::Mirror::alone});
    }
    void addBall(const glm::dvec3& centre, double radius) {
        curved.push_back({curved.size(), centre, radius, {}, true});
    }
    void look(const glm::dvec3& eye, const glm::dvec3& target) {
        view.view = reflection::perspectiveView(eye, target, 1.0, 4.0 / 3);
        view.size = {640, 480};
    }
    reflection::ReflectionScene scene() const {
        reflection::ReflectionScene s;
        s.mirrors = mirrors;
        s.curved = curved;
        return s;
    }
};

/// A square of half width h around a centre, facing along `normal`, one of the six axes.
inline std::vector<glm::dvec3> square(const glm::dvec3& centre, const glm::dvec3& normal, double h) {
    const glm::dvec3 u = std::abs(normal.z) > 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 v = glm::cross(normal, u);
    return {centre - h * u - h * v, centre + h * u - h * v, centre + h * u + h * v, centre - h * u + h * v};
}

/// (a): a room of six mirrors, seen from outside through the back of one.
inline CountedScene mirrorRoom() {
    CountedScene s;
    for (int axis = 0; axis < 3; ++axis)
        for (double side : {-1.0, 1.0}) {
            glm::dvec3 n(0);
            n[axis] = side;
            s.addMirror(square(n, -n, 1));
        }
    s.addBall({0, 0, 0}, 0.3);
    s.look({-4, 0.2, 0.1}, {0, 0, 0});
    return s;
}

/// (b): a mirror floor under three balls.
inline CountedScene mirrorFloor() {
    CountedScene s;
    s.addMirror(square({0, 0, 0}, {0, 0, 1}, 3));
    for (double x : {-1.2, 0.0, 1.2}) s.addBall({x, 0, 0.5}, 0.4);
    s.look({0, -6, 2}, {0, 0, 0.3});
    return s;
}

/// (c): two mirrors that face each other's front, two balls between.
inline CountedScene mirrorPair() {
    CountedScene s;
    s.addMirror(square({0, 0, 0}, {0, 0, 1}, 3));
    s.addMirror(square({0, 3, 3}, {0, -1, 0}, 3));
    s.addBall({-1, 0, 1}, 0.5);
    s.addBall({1, 0, 1}, 0.5);
    s.look({0, -7, 2}, {0, 0, 1});
    return s;
}

/// (d): a corner of three mirrors before which a ball hangs.
inline CountedScene mirrorCorner() {
    CountedScene s;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 n(0);
        n[axis] = 1;
        s.addMirror(square(glm::dvec3(1.5) - 1.5 * n, n, 1.5));
    }
    s.addBall({1, 1, 1}, 0.4);
    s.look({5, 4, 4}, {0.8, 0.8, 0.8});
    s.depth = 3;
    return s;
}
