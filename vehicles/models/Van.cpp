#include "vehicles/models/Assemble.h"
#include "vehicles/models/Bodies.h"
#include "vehicles/models/Cage.h"
#include "vehicles/models/Outline.h"
#include "vehicles/models/Parts.h"
#include "vehicles/models/WheelArch.h"

namespace vehicles {
namespace {

constexpr float front = 1.60f, rear = -1.60f;  // axles

Cage cage() {
    Cage c;
    //            centre x, z    rail                     belt                     shoulder waist rocker sill
    c.stations = {
        {{2.43f, .980f},
         {2.33f, .560f, .965f},
         {2.26f, .760f, .930f},
         {2.23f, .820f, .850f},
         {2.22f, .850f, .600f},
         {2.24f, .830f, .330f},
         {2.20f, .780f, .220f}},
        {{2.28f, 1.080f},
         {2.16f, .640f, 1.060f},
         {2.09f, .860f, 1.010f},
         {2.06f, .915f, .900f},
         {2.05f, .945f, .620f},
         {2.05f, .930f, .330f},
         {2.05f, .850f, .210f}},
        {{1.93f, 1.185f},
         {1.78f, .730f, 1.160f},
         {1.76f, .905f, 1.090f},
         {1.76f, .955f, .940f},
         {1.76f, .975f, .640f},
         {1.76f, .960f, .320f},
         {1.76f, .870f, .200f}},
        {{1.50f, 1.600f},
         {1.34f, .755f, 1.540f},
         {1.34f, .925f, 1.130f},
         {1.34f, .980f, .960f},
         {1.34f, .990f, .650f},
         {1.34f, .975f, .310f},
         {1.34f, .880f, .195f}},
        {{1.08f, 2.000f},
         {.920f, .755f, 1.930f},
         {.900f, .945f, 1.150f},
         {.900f, .990f, .970f},
         {.900f, 1.00f, .650f},
         {.900f, .985f, .310f},
         {.900f, .880f, .195f}},
        {{.850f, 2.100f},
         {.700f, .760f, 2.020f},
         {.700f, .950f, 1.155f},
         {.700f, .993f, .972f},
         {.700f, 1.00f, .650f},
         {.700f, .985f, .310f},
         {.700f, .880f, .195f}},
        {{.200f, 2.180f},
         {.200f, .775f, 2.095f},
         {.200f, .955f, 1.160f},
         {.200f, .995f, .975f},
         {.200f, 1.00f, .650f},
         {.200f, .985f, .310f},
         {.200f, .880f, .195f}},
        {{-.800f, 2.205f},
         {-.800f, .780f, 2.120f},
         {-.800f, .957f, 1.165f},
         {-.800f, .995f, .980f},
         {-.800f, 1.00f, .650f},
         {-.800f, .985f, .310f},
         {-.800f, .880f, .195f}},
        {{-1.80f, 2.200f},
         {-1.80f, .780f, 2.115f},
         {-1.80f, .957f, 1.170f},
         {-1.80f, .995f, .985f},
         {-1.80f, 1.00f, .650f},
         {-1.80f, .985f, .320f},
         {-1.80f, .880f, .200f}},
        {{-2.50f, 2.165f},
         {-2.48f, .775f, 2.080f},
         {-2.48f, .950f, 1.175f},
         {-2.48f, .985f, .990f},
         {-2.48f, .988f, .650f},
         {-2.48f, .970f, .340f},
         {-2.46f, .870f, .240f}},
        {{-2.66f, 2.060f},
         {-2.63f, .740f, 2.000f},
         {-2.66f, .895f, 1.175f},
         {-2.68f, .930f, .990f},
         {-2.69f, .935f, .650f},
         {-2.69f, .915f, .360f},
         {-2.66f, .830f, .270f}},
    };
    c.frontX = {0, 2.470f, 2.490f, 2.520f, 2.515f, 2.440f};
    c.rearX = {0, -2.735f, -2.750f, -2.760f, -2.780f, -2.740f};
    c.creases = {
        {{2, 0, 0}, {2, 3, 0}, 2.5f},   // foot of the windscreen
        {{2, 3, 0}, {4, 3, 0}, 1.8f},   // front pillar
        {{4, 3, 0}, {10, 3, 0}, 1.4f},  // roof's edge
        {{4, 0, 0}, {4, 3, 0}, 0.8f},   // head of the windscreen
        {{2, 3, 1}, {10, 3, 1}, 1.8f},  // belt
        {{1, 3, 2}, {10, 3, 2}, 1.5f},  // character line
        {{0, 3, 4}, {10, 3, 4}, 1.2f},  // rocker
        {{0, 3, 5}, {10, 3, 5}, 4.0f},  // floor
        {{0, 0, 5}, {0, 3, 5}, 4.0f},   {{10, 0, 5}, {10, 3, 5}, 4.0f},
        {{0, 0, 0}, {0, 3, 0}, 1.0f},   {{10, 3, 0}, {10, 3, 5}, 1.2f},  // rear corner
        {{10, 0, 0}, {10, 3, 0}, 1.5f},
    };
    return c;
}

void drawLines(Shell& half) {
    addGap(half, both(inSideView(Outline({{1.18f, .30f},
                                          {1.22f, .60f},
                                          {1.26f, 1.10f},
                                          {1.18f, 1.55f},
                                          {.96f, 1.93f},
                                          {.42f, 1.98f},
                                          {.38f, .30f}},
                                         .06f),
                                 .5f, 0),
                      below(2.1f)));
    addGap(half,
           inSideView(Outline({{.36f, .30f}, {.36f, 1.99f}, {-.86f, 2.02f}, {-.86f, .30f}}, .05f), .5f, 0));
    addGap(half,
           inSideView(Outline({{-3.6f, 1.215f}, {-.90f, 1.210f}, {-.90f, 1.19f}, {-3.6f, 1.195f}}, .004f),
                      .5f, 0));
    addGap(half,
           inTopView(
               Outline(
                   {{1.94f, -.2f}, {1.86f, .66f}, {1.76f, .80f}, {2.05f, .80f}, {2.28f, .66f}, {2.42f, -.2f}},
                   .05f),
               .90f));
    addGap(half, inRearView(
                     Outline({{-.2f, 2.01f}, {.72f, 2.00f}, {.86f, 1.17f}, {.85f, .50f}, {-.2f, .48f}}, .06f),
                     -2.55f));
    half.assign(below(.36f), Surface::trim);
    addPanel(
        half,
        inSideView(Outline({{1.30f, .56f}, {1.30f, .64f}, {-1.20f, .64f}, {-1.20f, .56f}}, .02f), .5f, 0),
        Surface::trim);

    // Windows.
    addGlass(
        half,
        inFrontView(Outline({{-.3f, 1.230f}, {.700f, 1.230f}, {.690f, 1.900f}, {-.3f, 1.930f}}, .08f), .7f),
        .02f);
    addGlass(half,
             inSideView(Outline({{{1.52f, 1.21f}, .04f},
                                 {{1.30f, 1.50f}, .1f},
                                 {{.94f, 1.87f}, .06f},
                                 {{.46f, 1.91f}, .05f},
                                 {{.46f, 1.215f}, .04f}}),
                        .4f, .9f),
             .016f);
    addGlass(half,
             inSideView(Outline({{{.28f, 1.225f}, .06f},
                                 {{.28f, 1.90f}, .06f},
                                 {{-.78f, 1.92f}, .06f},
                                 {{-.78f, 1.235f}, .06f}}),
                        .4f, .9f),
             .016f);
    addGlass(half,
             inSideView(Outline({{{-.96f, 1.235f}, .06f},
                                 {{-.96f, 1.92f}, .06f},
                                 {{-2.36f, 1.90f}, .08f},
                                 {{-2.38f, 1.245f}, .06f}}),
                        .4f, .9f),
             .016f);
    addGlass(half,
             inRearView(Outline({{-.3f, 1.26f}, {.70f, 1.26f}, {.64f, 1.88f}, {-.3f, 1.90f}}, .08f), -2.55f),
             .02f);

    // Front: lamps, grille, intake, plate.
    addPanel(half,
             roundTheFront(Outline({{{.52f, .790f}, .03f},
                                    {{1.02f, .800f}, .05f},
                                    {{1.18f, .960f}, .04f},
                                    {{.60f, .905f}, .05f}}),
                           2.42f),
             Surface::headLamp, .010f);
    addPanel(half,
             inFrontView(Outline({{-.2f, .800f}, {.46f, .800f}, {.50f, .895f}, {-.2f, .900f}}, .03f), 2.0f),
             Surface::trim, .014f, Surface::chrome);
    addPanel(
        half,
        inFrontView(Outline({{-.2f, .843f}, {.475f, .843f}, {.475f, .855f}, {-.2f, .855f}}, .004f), 2.0f),
        Surface::chrome);
    addPanel(half,
             inFrontView(Outline({{-.2f, .370f}, {.62f, .370f}, {.70f, .52f}, {-.2f, .52f}}, .05f), 2.0f),
             Surface::trim);
    addPanel(half,
             inFrontView(Outline({{-.2f, .575f}, {.26f, .575f}, {.26f, .685f}, {-.2f, .685f}}, .01f), 2.0f),
             Surface::rim, .006f);

    // Rear: tall lamps at the corners, plate, bumper.
    addPanel(
        half,
        roundTheRear(
            Outline(
                {{{.87f, .82f}, .03f}, {{.86f, 1.26f}, .03f}, {{.99f, 1.30f}, .03f}, {{1.02f, .82f}, .03f}}),
            -2.70f),
        Surface::tailLamp, .006f);
    addPanel(half, inRearView(Outline({{-.2f, .20f}, {1.1f, .20f}, {1.1f, .44f}, {-.2f, .44f}}, .02f), -2.5f),
             Surface::trim);
    addPanel(half, inRearView(Outline({{-.2f, .80f}, {.26f, .80f}, {.26f, .91f}, {-.2f, .91f}}, .01f), -2.5f),
             Surface::rim, .02f);
}

}  // namespace

VehicleModel van() {
    Assembly plan{.name = "van",
                  .length = 5.30f,
                  .width = 2.00f,
                  .height = 2.20f,
                  .track = 1.70f,
                  .wheel = {.radius = .345f, .width = .225f, .rimRadius = .215f, .spokes = 6},
                  .axles = {front, rear}};
    Shell half = subdivide(
        cage(), {.rear = -2.78f, .front = 2.52f, .width = plan.width, .floor = .20f, .top = plan.height}, 2);
    city::Mesh parts;
    drawLines(half);
    for (const float x : {front, rear})
        cutWheelArch(half, parts, {.x = x, .z = plan.wheel.radius + .01f, .radius = .400f, .inner = .60f});
    addDoorMirror(parts, {1.42f, sideAt(half, 1.42f, 1.2f), 1.24f}, 1.35f);
    addHandle(parts, {.52f, sideAt(half, .52f, 1.06f), 1.06f}, Surface::trim);
    addHandle(parts, {.22f, sideAt(half, .22f, 1.06f), 1.06f}, Surface::trim);
    return assemble(plan, std::move(half), parts, {});
}

}  // namespace vehicles
