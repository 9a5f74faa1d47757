#include "vehicles/models/Assemble.h"
#include "vehicles/models/Bodies.h"
#include "vehicles/models/Bumper.h"
#include "vehicles/models/Cage.h"
#include "vehicles/models/Outline.h"
#include "vehicles/models/Parts.h"
#include "vehicles/models/WheelArch.h"

namespace vehicles {
namespace {

constexpr float front = 1.40f, rear = -1.40f;  // axles

Cage cage() {
    Cage c;
    //            centre x, z    rail                     belt                     shoulder waist rocker sill
    c.stations = {
        {{2.20f, .740f},
         {2.10f, .520f, .730f},
         {2.03f, .680f, .705f},
         {2.01f, .745f, .640f},
         {2.00f, .780f, .490f},
         {2.02f, .765f, .290f},
         {1.98f, .720f, .200f}},
        {{2.07f, .820f},
         {1.94f, .580f, .808f},
         {1.87f, .785f, .765f},
         {1.85f, .850f, .680f},
         {1.85f, .878f, .510f},
         {1.85f, .865f, .290f},
         {1.85f, .800f, .190f}},
        {{1.75f, .885f},
         {1.62f, .620f, .872f},
         {1.58f, .825f, .830f},
         {1.57f, .890f, .730f},
         {1.57f, .910f, .540f},
         {1.57f, .895f, .290f},
         {1.57f, .820f, .175f}},
        {{1.35f, .930f},
         {1.22f, .660f, .915f},
         {1.19f, .845f, .870f},
         {1.19f, .905f, .755f},
         {1.19f, .918f, .550f},
         {1.19f, .905f, .280f},
         {1.19f, .830f, .170f}},
        {{.980f, .970f},
         {.780f, .700f, .938f},
         {.760f, .838f, .890f},
         {.760f, .900f, .770f},
         {.760f, .920f, .560f},
         {.760f, .905f, .270f},
         {.760f, .830f, .170f}},
        {{.500f, 1.205f},
         {.340f, .655f, 1.145f},
         {.340f, .832f, .902f},
         {.340f, .898f, .780f},
         {.340f, .920f, .565f},
         {.340f, .905f, .270f},
         {.340f, .830f, .170f}},
        {{.020f, 1.400f},
         {-.10f, .600f, 1.340f},
         {-.08f, .830f, .912f},
         {-.08f, .898f, .788f},
         {-.08f, .920f, .570f},
         {-.08f, .905f, .270f},
         {-.08f, .830f, .170f}},
        {{-.480f, 1.450f},
         {-.500f, .588f, 1.380f},
         {-.500f, .828f, .922f},
         {-.500f, .900f, .795f},
         {-.500f, .920f, .572f},
         {-.500f, .905f, .270f},
         {-.500f, .830f, .170f}},
        {{-.980f, 1.415f},
         {-.960f, .578f, 1.345f},
         {-.960f, .822f, .935f},
         {-.960f, .902f, .805f},
         {-.960f, .920f, .575f},
         {-.960f, .905f, .275f},
         {-.960f, .830f, .170f}},
        {{-1.38f, 1.240f},
         {-1.36f, .600f, 1.170f},
         {-1.36f, .805f, .945f},
         {-1.36f, .900f, .815f},
         {-1.36f, .918f, .578f},
         {-1.36f, .900f, .285f},
         {-1.36f, .825f, .175f}},
        {{-1.80f, 1.030f},
         {-1.72f, .640f, .985f},
         {-1.70f, .780f, .935f},
         {-1.70f, .885f, .815f},
         {-1.70f, .908f, .580f},
         {-1.70f, .890f, .300f},
         {-1.70f, .815f, .190f}},
        {{-2.15f, 1.015f},
         {-2.05f, .620f, .975f},
         {-2.03f, .755f, .925f},
         {-2.04f, .845f, .810f},
         {-2.06f, .872f, .580f},
         {-2.06f, .855f, .320f},
         {-2.04f, .785f, .220f}},
        {{-2.37f, 1.005f},
         {-2.27f, .560f, .970f},
         {-2.23f, .680f, .915f},
         {-2.23f, .745f, .800f},
         {-2.25f, .780f, .570f},
         {-2.25f, .765f, .340f},
         {-2.21f, .725f, .250f}},
    };
    c.frontX = {0, 2.240f, 2.255f, 2.270f, 2.265f, 2.190f};
    c.rearX = {0, -2.405f, -2.410f, -2.465f, -2.480f, -2.400f};
    c.creases = {
        {{4, 0, 0}, {4, 3, 0}, 2.5f},    // foot of the windscreen
        {{4, 3, 0}, {6, 3, 0}, 1.6f},    // front pillar
        {{6, 3, 0}, {8, 3, 0}, 1.2f},    // roof's edge
        {{8, 3, 0}, {10, 3, 0}, 1.0f},   // rear pillar
        {{1, 3, 0}, {4, 3, 0}, 0.8f},    // bonnet's edge
        {{4, 3, 1}, {9, 3, 1}, 1.8f},    // belt
        {{1, 3, 2}, {12, 3, 2}, 1.6f},   // character line
        {{0, 3, 4}, {12, 3, 4}, 1.0f},   // rocker
        {{10, 0, 0}, {10, 3, 0}, 1.5f},  // foot of the rear window
        {{12, 0, 0}, {12, 3, 0}, 2.0f},  // boot's edge
        {{0, 3, 5}, {12, 3, 5}, 4.0f},   // floor
        {{0, 0, 5}, {0, 3, 5}, 4.0f},   {{12, 0, 5}, {12, 3, 5}, 4.0f},
        {{0, 0, 0}, {0, 3, 0}, 1.2f},    // bonnet's front edge
        {{12, 0, 3}, {12, 3, 3}, 1.5f},  // rear bumper's step
    };
    return c;
}

void drawLines(Shell& half) {
    const Field belowBelt = below(0.935f, -0.022f);
    addGap(
        half,
        both(inSideView(
                 Outline(
                     {{.72f, .250f}, {.78f, .50f}, {.74f, .90f}, {.58f, 1.1f}, {-.49f, 1.1f}, {-.49f, .250f}},
                     .06f),
                 .5f, 0),
             belowBelt));
    addGap(half, both(inSideView(Outline({{{-.49f, .250f}, .03f},
                                          {{-.49f, 1.1f}, .03f},
                                          {{-1.38f, 1.1f}, .05f},
                                          {{-1.34f, .80f}, .2f},
                                          {{-1.02f, .60f}, .12f},
                                          {{-.98f, .250f}, .06f}}),
                                 .5f, 0),
                      belowBelt));
    addGap(half,
           inTopView(
               Outline(
                   {{1.02f, -.2f}, {.92f, .62f}, {.80f, .735f}, {1.80f, .670f}, {2.10f, .55f}, {2.21f, -.2f}},
                   .05f),
               .68f));
    addGap(half,
           either(inTopView(Outline({{-1.86f, -.2f}, {-1.80f, .63f}, {-2.60f, .58f}, {-2.60f, -.2f}}, .05f),
                            .93f),
                  inRearView(
                      Outline({{-.2f, 1.2f}, {.59f, 1.2f}, {.60f, .80f}, {.52f, .665f}, {-.2f, .665f}}, .06f),
                      -2.2f)));
    half.assign(below(.265f), Surface::trim);

    // Windows.
    addGlass(
        half,
        inFrontView(Outline({{-.3f, 1.005f}, {.635f, 1.005f}, {.545f, 1.345f}, {-.3f, 1.365f}}, .06f), -.2f));
    const Field daylight = inSideView(Outline({{{.62f, .952f}, .03f},
                                               {{-.08f, 1.298f}, .10f},
                                               {{-.55f, 1.336f}, .25f},
                                               {{-1.00f, 1.300f}, .15f},
                                               {{-1.40f, 1.085f}, .08f},
                                               {{-1.50f, .985f}, .03f}}),
                                      .4f, .9f);
    half.refine(daylight, 0.035f);
    half.assign(grown(daylight, .022f), Surface::chrome);
    half.assign(grown(daylight, .010f), Surface::trim);
    addGlass(half,
             inSideView(Outline({{{.56f, .966f}, .02f},
                                 {{-.09f, 1.288f}, .08f},
                                 {{-.445f, 1.325f}, .03f},
                                 {{-.445f, .972f}, .02f}}),
                        .4f, .9f),
             .004f);
    addGlass(half,
             inSideView(Outline({{{-.535f, .974f}, .02f},
                                 {{-.535f, 1.325f}, .03f},
                                 {{-.98f, 1.290f}, .10f},
                                 {{-1.13f, 1.215f}, .03f},
                                 {{-1.17f, .985f}, .02f}}),
                        .4f, .9f),
             .004f);
    addGlass(half,
             inSideView(Outline({{{-1.205f, .985f}, .02f},
                                 {{-1.165f, 1.198f}, .02f},
                                 {{-1.37f, 1.085f}, .06f},
                                 {{-1.45f, .995f}, .03f}}),
                        .4f, .9f),
             .004f);
    addGlass(
        half,
        inRearView(Outline({{-.3f, 1.055f}, {.595f, 1.045f}, {.525f, 1.325f}, {-.3f, 1.350f}}, .07f), -.98f));

    // Front: lamps, grille, intake.
    addPanel(half,
             roundTheFront(Outline({{{.48f, .620f}, .03f},
                                    {{.88f, .640f}, .05f},
                                    {{1.10f, .725f}, .04f},
                                    {{.60f, .712f}, .05f}}),
                           2.19f),
             Surface::headLamp, .008f);
    addPanel(half,
             inFrontView(Outline({{-.2f, .515f}, {.30f, .515f}, {.40f, .690f}, {-.2f, .700f}}, .04f), 1.9f),
             Surface::trim, .014f, Surface::chrome);
    for (const float z : {.560f, .605f, .650f})
        addPanel(
            half,
            inFrontView(
                Outline({{-.2f, z - .006f}, {.31f, z - .006f}, {.31f, z + .006f}, {-.2f, z + .006f}}, .004f),
                1.9f),
            Surface::chrome);
    addPanel(half,
             inFrontView(Outline({{-.2f, .270f}, {.56f, .270f}, {.62f, .380f}, {-.2f, .375f}}, .04f), 1.9f),
             Surface::trim);

    // Rear: lamps, plate, bumper insert.
    addPanel(half,
             roundTheRear(Outline({{{.40f, .800f}, .03f},
                                   {{.40f, .905f}, .03f},
                                   {{1.05f, .925f}, .04f},
                                   {{1.00f, .790f}, .05f}}),
                          -2.39f),
             Surface::tailLamp, .006f);
    addPanel(half, inRearView(Outline({{-.2f, .23f}, {.62f, .23f}, {.58f, .36f}, {-.2f, .36f}}, .04f), -2.1f),
             Surface::trim);
    addPanel(half,
             inRearView(Outline({{-.2f, .690f}, {.26f, .690f}, {.26f, .795f}, {-.2f, .795f}}, .01f), -2.1f),
             Surface::rim, .015f);
}

}  // namespace

VehicleModel saloon() {
    Assembly plan{.name = "saloon",
                  .length = 4.75f,
                  .width = 1.83f,
                  .height = 1.45f,
                  .track = 1.59f,
                  .wheel = {.radius = .325f, .width = .225f, .rimRadius = .228f, .cover = true},
                  .axles = {front, rear}};
    Shell half = subdivide(
        cage(), {.rear = -2.48f, .front = 2.27f, .width = plan.width, .floor = .17f, .top = plan.height}, 2);
    city::Mesh parts;
    drawLines(half);
    for (const float x : {front, rear})
        cutWheelArch(half, parts, {.x = x, .z = plan.wheel.radius + .01f, .radius = .372f, .inner = .54f});
    addDoorMirror(parts, {.55f, sideAt(half, .55f, .93f), .97f}, 1, Surface::chrome);
    addBumper(parts, half, {.z = .447f, .centre = 1.30f, .halfAngle = .98f});
    addBumper(parts, half,
              {.z = .500f, .halfHeight = .045f, .centre = -1.40f, .halfAngle = .98f, .rear = true});
    for (const float x : {-.35f, -1.20f}) addHandle(parts, {x, sideAt(half, x, .785f), .785f});
    // The front plate stands before the bumper.
    city::Mesh plate;
    const float before = 1.30f + outlineAt(half, .447f, 1.30f, 1e-3f) + .064f;
    addBox(plate, {before - .012f, -.26f, .392f}, {before, .26f, .502f}, Surface::rim);
    return assemble(plan, std::move(half), parts, plate);
}

}  // namespace vehicles
