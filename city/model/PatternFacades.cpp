#include <glm/common.hpp>

#include "city/model/PatternCanvas.h"
#include "city/model/PatternPainters.h"

namespace city {

namespace {

constexpr int facadeSize = 256;
// Dark, slightly blue: the static city is diffuse, so glass is painted as it looks with a dim room behind it
// and some sky in front.
constexpr glm::vec3 glassLow{0.16f, 0.2f, 0.25f}, glassHigh{0.3f, 0.37f, 0.46f};

void paintPane(PatternCanvas& canvas, glm::vec2 low, glm::vec2 high) {
    canvas.box(low, high, glassLow, glassHigh);
}

/// Two casements under a light, in a frame, with a shadow under the lintel and curtains inside.
void paintWindow(PatternCanvas& canvas, glm::vec2 low, glm::vec2 high, const glm::vec3& frame) {
    const glm::vec2 size = high - low;
    canvas.box(low, high, frame);
    const float bar = 0.022f;
    const float middle = low.x + 0.5f * size.x, transom = low.y + 0.68f * size.y;
    for (int k = 0; k < 2; ++k) {
        const float x0 = (k == 0 ? low.x : middle - 0.4f * bar) + bar,
                    x1 = (k == 0 ? middle + 0.4f * bar : high.x) - bar;
        paintPane(canvas, {x0, low.y + bar}, {x1, transom - 0.5f * bar});
        paintPane(canvas, {x0, transom + 0.5f * bar}, {x1, high.y - bar});
        // Curtain: a paler fold at the outer edge of each casement.
        const float c0 = k == 0 ? x0 : x1 - 0.22f * (x1 - x0), c1 = k == 0 ? x0 + 0.22f * (x1 - x0) : x1;
        canvas.box({c0, low.y + bar}, {c1, transom - 0.5f * bar}, {0.42f, 0.43f, 0.44f},
                   {0.5f, 0.51f, 0.52f});
    }
    // The reveal throws a shadow from above and, a little, from the side.
    canvas.shade({low.x, high.y - 0.035f}, high, 1.0f, 0.55f);
    canvas.shade(low, {low.x + 0.012f, high.y}, 0.75f, 0.75f);
}

}  // namespace

PatternImage paintPlasterFacade() {
    PatternCanvas canvas(facadeSize);
    canvas.fill(glm::vec3(0.955f));
    canvas.grain(6, 5, 0.035f, 11);
    const glm::vec2 low(0.3f, 0.24f), high(0.7f, 0.83f);
    const glm::vec3 trim(1.0f), edge(0.8f);
    // Surround, lintel and sill stand out from the plaster.
    canvas.box({low.x - 0.052f, low.y - 0.02f}, {high.x + 0.052f, high.y + 0.05f}, edge);
    canvas.box({low.x - 0.045f, low.y - 0.015f}, {high.x + 0.045f, high.y + 0.045f}, trim);
    canvas.box({low.x - 0.075f, high.y + 0.045f}, {high.x + 0.075f, high.y + 0.08f}, trim);
    canvas.shade({low.x - 0.075f, high.y + 0.028f}, {high.x + 0.075f, high.y + 0.045f}, 1.0f, 0.7f);
    canvas.box({low.x - 0.075f, low.y - 0.05f}, {high.x + 0.075f, low.y - 0.012f}, trim);
    canvas.shade({low.x - 0.07f, low.y - 0.085f}, {high.x + 0.07f, low.y - 0.05f}, 0.97f, 0.72f);
    paintWindow(canvas, low, high, glm::vec3(0.93f, 0.93f, 0.91f));
    // A thin band marks the storeys.
    canvas.box({0, 0.02f}, {1, 0.045f}, glm::vec3(0.99f));
    canvas.box({0, 0.008f}, {1, 0.02f}, glm::vec3(0.84f));
    return canvas.image();
}

PatternImage paintBrickFacade() {
    PatternCanvas canvas(facadeSize);
    // Half of the brick's hue is in the picture, half in the tint: frames stay paler than the wall.
    canvas.fill({0.86f, 0.84f, 0.81f});
    constexpr int courses = 40, bricks = 12;
    for (int row = 0; row < courses; ++row) {
        const float v = static_cast<float>(row) / courses;
        for (int k = -1; k < bricks; ++k) {
            const float u = (static_cast<float>(k) + (row % 2 == 0 ? 0.0f : 0.5f)) / bricks;
            const auto column = static_cast<std::uint32_t>((k + bricks) % bricks);
            const float tone = 0.86f + 0.12f * latticeValue(column, static_cast<std::uint32_t>(row), 21);
            const float hue = 0.05f * latticeValue(column, static_cast<std::uint32_t>(row), 22);
            canvas.box({u + 0.006f, v + 0.0045f}, {u + 1.0f / bricks - 0.002f, v + 1.0f / courses - 0.0005f},
                       tone * glm::vec3(0.97f, 0.82f + hue, 0.76f + hue));
        }
    }
    canvas.grain(8, 5, 0.04f, 12);
    const glm::vec2 low(0.27f, 0.2f), high(0.73f, 0.8f);
    const glm::vec3 stone(1.0f, 0.99f, 0.96f);
    canvas.box({low.x - 0.07f, high.y}, {high.x + 0.07f, high.y + 0.075f}, stone);
    canvas.box({0.47f, high.y - 0.01f}, {0.53f, high.y + 0.095f}, stone);
    canvas.box({low.x - 0.06f, low.y - 0.045f}, {high.x + 0.06f, low.y}, stone);
    canvas.shade({low.x - 0.06f, low.y - 0.075f}, {high.x + 0.06f, low.y - 0.045f}, 0.97f, 0.65f);
    paintWindow(canvas, low, high, stone);
    return canvas.image();
}

PatternImage paintStoneFacade() {
    PatternCanvas canvas(facadeSize);
    canvas.fill(glm::vec3(0.78f));
    constexpr int courses = 8;
    for (int row = 0; row < courses; ++row) {
        const float v = static_cast<float>(row) / courses, shift = row % 2 == 0 ? 0.0f : 0.25f;
        for (int k = -1; k < 2; ++k) {
            const float u = static_cast<float>(k) * 0.5f + shift;
            const auto column = static_cast<std::uint32_t>(k + 2) % 2;
            const float tone = 0.9f + 0.08f * latticeValue(column, static_cast<std::uint32_t>(row), 31);
            canvas.box({u + 0.004f, v + 0.005f}, {u + 0.496f, v + 0.12f},
                       glm::vec3(tone, 0.995f * tone, 0.98f * tone), glm::vec3(tone + 0.02f));
        }
    }
    canvas.grain(10, 5, 0.05f, 13);
    const glm::vec2 low(0.28f, 0.16f), high(0.72f, 0.84f);
    const glm::vec3 trim(0.98f, 0.97f, 0.94f);
    canvas.box({low.x - 0.06f, low.y - 0.02f}, {high.x + 0.06f, high.y + 0.06f}, glm::vec3(0.8f));
    canvas.box({low.x - 0.052f, low.y - 0.02f}, {high.x + 0.052f, high.y + 0.052f}, trim);
    canvas.box({low.x - 0.09f, high.y + 0.06f}, {high.x + 0.09f, high.y + 0.1f}, trim);
    canvas.shade({low.x - 0.09f, high.y + 0.035f}, {high.x + 0.09f, high.y + 0.06f}, 1.0f, 0.65f);
    canvas.box({low.x - 0.09f, low.y - 0.065f}, {high.x + 0.09f, low.y - 0.02f}, trim);
    canvas.shade({low.x - 0.085f, low.y - 0.1f}, {high.x + 0.085f, low.y - 0.065f}, 0.97f, 0.68f);
    paintWindow(canvas, low, high, glm::vec3(0.42f, 0.36f, 0.3f));
    return canvas.image();
}

PatternImage paintGlassFacade() {
    PatternCanvas canvas(facadeSize);
    canvas.fill(glm::vec3(0.8f, 0.81f, 0.83f));  // mullions
    for (int k = 0; k < 2; ++k) {
        const float u0 = 0.5f * static_cast<float>(k) + 0.012f,
                    u1 = 0.5f * static_cast<float>(k + 1) - 0.012f;
        canvas.box({u0, 0.27f}, {u1, 0.985f}, {0.3f, 0.38f, 0.45f}, {0.5f, 0.6f, 0.7f});
        canvas.box({u0, 0.02f}, {u1, 0.25f}, {0.5f, 0.55f, 0.6f},
                   {0.53f, 0.58f, 0.63f});  // in front of the floor
    }
    // Blinds half down in one of the panes, ceiling lights as a pale row.
    canvas.box({0.515f, 0.7f}, {0.985f, 0.985f}, {0.66f, 0.69f, 0.72f}, {0.72f, 0.75f, 0.78f});
    for (int k = 0; k < 8; ++k)
        canvas.box({0.515f, 0.7f + 0.035f * static_cast<float>(k)},
                   {0.985f, 0.706f + 0.035f * static_cast<float>(k)}, glm::vec3(0.56f, 0.58f, 0.61f));
    canvas.box({0.05f, 0.88f}, {0.44f, 0.9f}, glm::vec3(0.74f, 0.76f, 0.74f));
    canvas.grain(4, 3, 0.02f, 14);
    return canvas.image();
}

PatternImage paintShopFront() {
    PatternCanvas canvas(facadeSize);
    const glm::vec3 frame(0.9f), panel(0.8f);
    canvas.fill(frame);
    canvas.grain(6, 4, 0.02f, 15);
    // Plinth, window to the left, door to the right, fascia above.
    canvas.box({0, 0}, {1, 0.1f}, glm::vec3(0.55f), glm::vec3(0.6f));
    canvas.box({0.05f, 0.1f}, {0.62f, 0.78f}, panel);
    const auto pane = [&](glm::vec2 low, glm::vec2 high) {
        canvas.box(low, high, {0.2f, 0.2f, 0.2f}, {0.33f, 0.38f, 0.44f});
    };
    pane({0.065f, 0.115f}, {0.335f, 0.765f});
    pane({0.35f, 0.115f}, {0.605f, 0.765f});
    // Goods on shelves, lit from above, never quite in order.
    for (std::uint32_t k = 0; k < 14; ++k) {
        const float u = 0.085f + 0.036f * static_cast<float>(k);
        if (u > 0.3f && u < 0.37f) continue;
        const float height = 0.06f + 0.13f * latticeValue(k, 0, 41);
        const glm::vec3 goods(0.35f + 0.5f * latticeValue(k, 1, 41), 0.3f + 0.4f * latticeValue(k, 2, 41),
                              0.25f + 0.4f * latticeValue(k, 3, 41));
        canvas.box({u, 0.14f}, {u + 0.026f, 0.14f + height}, 0.75f * goods, goods);
        const float upper = 0.04f + 0.07f * latticeValue(k, 4, 41);
        canvas.box({u, 0.4f}, {u + 0.026f, 0.4f + upper}, 0.55f * glm::vec3(goods.z, goods.x, goods.y),
                   0.7f * glm::vec3(goods.z, goods.x, goods.y));
    }
    canvas.box({0.065f, 0.39f}, {0.335f, 0.4f}, glm::vec3(0.45f));
    canvas.box({0.35f, 0.39f}, {0.605f, 0.4f}, glm::vec3(0.45f));
    for (const float u : {0.13f, 0.26f, 0.42f, 0.54f})
        canvas.spot({u, 0.7f}, {0.014f, 0.018f}, {0.95f, 0.9f, 0.75f});
    // Door.
    canvas.box({0.67f, 0.0f}, {0.93f, 0.78f}, panel);
    pane({0.7f, 0.13f}, {0.9f, 0.6f});
    pane({0.7f, 0.63f}, {0.9f, 0.76f});
    canvas.box({0.885f, 0.3f}, {0.897f, 0.42f}, glm::vec3(0.5f, 0.47f, 0.4f));
    canvas.shade({0.05f, 0.735f}, {0.93f, 0.78f}, 1.0f, 0.6f);
    canvas.box({0, 0.8f}, {1, 0.815f}, glm::vec3(0.7f));
    return canvas.image();
}

PatternImage paintStoneFront() {
    PatternCanvas canvas(facadeSize);
    canvas.fill(glm::vec3(0.86f));
    canvas.grain(6, 4, 0.02f, 16);
    // Black granite below, a joint every half bay; it goes round the door.
    const glm::vec2 stoneHigh(1, 0.155f);
    canvas.box({0, 0}, stoneHigh, glm::vec3(0.17f, 0.172f, 0.178f));
    // A lintel of the same, behind the string course: the picture's ends meet.
    canvas.box({0, 0.965f}, {1, 1}, glm::vec3(0.17f, 0.172f, 0.178f));
    canvas.grain({0, 0}, stoneHigh, 48, 3, 0.45f, 17);
    for (const float u : {0.0f, 0.33f})
        canvas.box({u - 0.002f, 0}, {u + 0.002f, stoneHigh.y}, glm::vec3(0.1f));
    canvas.box({0.05f, 0.16f}, {0.62f, 0.78f}, glm::vec3(0.42f));
    const auto clear = [&](glm::vec2 low, glm::vec2 high) {
        canvas.box(low, high, {0.2f, 0.2f, 0.2f}, {0.33f, 0.38f, 0.44f});
    };
    clear({0.065f, 0.175f}, {0.335f, 0.765f});
    clear({0.35f, 0.175f}, {0.605f, 0.765f});
    // A ceiling's lamps and the backs of tall shelves are what the clear part shows.
    for (std::uint32_t k = 0; k < 14; ++k) {
        const float u = 0.085f + 0.036f * static_cast<float>(k);
        if (u > 0.3f && u < 0.37f) continue;
        const float height = 0.03f + 0.07f * latticeValue(k, 0, 43);
        const glm::vec3 goods(0.3f + 0.4f * latticeValue(k, 1, 43), 0.3f + 0.3f * latticeValue(k, 2, 43),
                              0.28f + 0.3f * latticeValue(k, 3, 43));
        canvas.box({u, 0.43f}, {u + 0.026f, 0.43f + height}, 0.75f * goods, goods);
    }
    for (const float u : {0.13f, 0.26f, 0.42f, 0.54f})
        canvas.spot({u, 0.7f}, {0.014f, 0.018f}, {0.95f, 0.9f, 0.75f});
    // Frosted below eye level: milky, with what stands close behind it as soft stains.
    const auto frosted = [&](glm::vec2 low, glm::vec2 high, std::uint32_t seed) {
        canvas.box(low, high, {0.56f, 0.58f, 0.59f}, {0.66f, 0.68f, 0.69f});
        for (std::uint32_t k = 0; k < 5; ++k) {
            const glm::vec2 size = high - low;
            const glm::vec2 at = low + size * glm::vec2(0.2f + 0.6f * latticeValue(k, 0, seed),
                                                        0.22f + 0.45f * latticeValue(k, 1, seed));
            const glm::vec3 stain(0.42f + 0.2f * latticeValue(k, 2, seed),
                                  0.44f + 0.14f * latticeValue(k, 3, seed),
                                  0.44f + 0.14f * latticeValue(k, 4, seed));
            // Rings of falling opacity: no edge anywhere.
            for (const float r : {1.0f, 0.85f, 0.7f, 0.55f, 0.4f, 0.25f})
                canvas.spot(at, r * glm::min(glm::vec2(0.06f), 0.2f * size), stain, 0.16f);
        }
    };
    frosted({0.065f, 0.175f}, {0.335f, 0.43f}, 44);
    frosted({0.35f, 0.175f}, {0.605f, 0.43f}, 45);
    canvas.box({0.67f, 0.0f}, {0.93f, 0.78f}, glm::vec3(0.46f));
    frosted({0.7f, 0.13f}, {0.9f, 0.6f}, 46);
    clear({0.7f, 0.63f}, {0.9f, 0.76f});
    canvas.box({0.88f, 0.25f}, {0.892f, 0.48f}, glm::vec3(0.62f, 0.6f, 0.56f));
    canvas.shade({0.05f, 0.735f}, {0.93f, 0.78f}, 1.0f, 0.6f);
    canvas.box({0, 0.8f}, {1, 0.815f}, glm::vec3(0.5f));
    return canvas.image();
}

}  // namespace city
