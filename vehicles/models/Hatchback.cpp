#include "vehicles/models/Assemble.h"
#include "vehicles/models/Bodies.h"
#include "vehicles/models/Cage.h"
#include "vehicles/models/Outline.h"
#include "vehicles/models/Parts.h"
#include "vehicles/models/WheelArch.h"

namespace vehicles {
namespace {

constexpr float front = 1.275f, rear = -1.275f;  // axles

Cage cage() {
    Cage c;
    //            centre x, z    rail                     belt                     shoulder waist rocker sill
    c.stations = {
        {{2.03f, .760f},
         {1.93f, .500f, .750f},
         {1.87f, .650f, .720f},
         {1.85f, .710f, .650f},
         {1.85f, .745f, .500f},
         {1.86f, .735f, .300f},
         {1.82f, .700f, .200f}},
        {{1.92f, .850f},
         {1.79f, .560f, .835f},
         {1.73f, .755f, .785f},
         {1.71f, .815f, .690f},
         {1.70f, .842f, .520f},
         {1.70f, .830f, .300f},
         {1.70f, .780f, .190f}},
        {{1.62f, .915f},
         {1.50f, .600f, .900f},
         {1.46f, .795f, .850f},
         {1.45f, .858f, .740f},
         {1.45f, .875f, .550f},
         {1.45f, .860f, .300f},
         {1.45f, .800f, .180f}},
        {{1.28f, .960f},
         {1.15f, .630f, .945f},
         {1.12f, .812f, .890f},
         {1.12f, .871f, .770f},
         {1.12f, .882f, .560f},
         {1.12f, .870f, .290f},
         {1.12f, .800f, .180f}},
        {{1.00f, 1.00f},
         {.800f, .665f, .970f},
         {.780f, .805f, .915f},
         {.780f, .868f, .790f},
         {.780f, .885f, .570f},
         {.780f, .870f, .280f},
         {.780f, .800f, .180f}},
        {{.570f, 1.235f},
         {.420f, .635f, 1.175f},
         {.420f, .800f, .928f},
         {.420f, .866f, .800f},
         {.420f, .885f, .575f},
         {.420f, .870f, .280f},
         {.420f, .800f, .180f}},
        {{.140f, 1.430f},
         {.020f, .585f, 1.370f},
         {.040f, .800f, .938f},
         {.040f, .866f, .808f},
         {.040f, .885f, .580f},
         {.040f, .870f, .280f},
         {.040f, .800f, .180f}},
        {{-.350f, 1.475f},
         {-.380f, .575f, 1.405f},
         {-.380f, .798f, .948f},
         {-.380f, .866f, .816f},
         {-.380f, .885f, .585f},
         {-.380f, .870f, .280f},
         {-.380f, .800f, .180f}},
        {{-.950f, 1.465f},
         {-.930f, .565f, 1.390f},
         {-.930f, .792f, .960f},
         {-.930f, .868f, .828f},
         {-.930f, .886f, .590f},
         {-.930f, .870f, .285f},
         {-.930f, .800f, .180f}},
        {{-1.40f, 1.430f},
         {-1.34f, .548f, 1.350f},
         {-1.34f, .780f, .970f},
         {-1.32f, .864f, .840f},
         {-1.30f, .884f, .595f},
         {-1.30f, .868f, .300f},
         {-1.30f, .800f, .190f}},
        {{-1.70f, 1.370f},
         {-1.60f, .535f, 1.285f},
         {-1.62f, .755f, .975f},
         {-1.62f, .838f, .845f},
         {-1.62f, .862f, .600f},
         {-1.62f, .845f, .320f},
         {-1.62f, .790f, .210f}},
        {{-1.86f, 1.080f},
         {-1.78f, .575f, 1.050f},
         {-1.78f, .715f, .950f},
         {-1.79f, .788f, .830f},
         {-1.80f, .818f, .590f},
         {-1.80f, .800f, .330f},
         {-1.78f, .750f, .230f}},
        {{-1.93f, .930f},
         {-1.87f, .560f, .905f},
         {-1.86f, .660f, .870f},
         {-1.86f, .715f, .780f},
         {-1.88f, .745f, .580f},
         {-1.88f, .735f, .340f},
         {-1.84f, .700f, .250f}},
    };
    c.frontX = {0, 2.070f, 2.090f, 2.105f, 2.100f, 2.030f};
    c.rearX = {0, -1.960f, -1.975f, -2.010f, -2.020f, -1.950f};
    c.creases = {
        {{4, 0, 0}, {4, 3, 0}, 2.5f},    // foot of the windscreen
        {{4, 3, 0}, {6, 3, 0}, 1.6f},    // front pillar
        {{6, 3, 0}, {10, 3, 0}, 1.2f},   // roof's edge
        {{1, 3, 0}, {4, 3, 0}, 0.8f},    // bonnet's edge
        {{4, 3, 1}, {11, 3, 1}, 1.8f},   // belt
        {{1, 3, 2}, {12, 3, 2}, 1.5f},   // character line
        {{0, 3, 4}, {12, 3, 4}, 1.0f},   // rocker
        {{10, 0, 0}, {10, 3, 0}, 2.0f},  // roof's rear edge
        {{0, 3, 5}, {12, 3, 5}, 4.0f},   // floor
        {{0, 0, 5}, {0, 3, 5}, 4.0f},   {{12, 0, 5}, {12, 3, 5}, 4.0f},
        {{0, 0, 0}, {0, 3, 0}, 1.2f},    // bonnet's front edge
        {{12, 0, 3}, {12, 3, 3}, 1.5f},  // rear bumper's step
    };
    return c;
}

void drawLines(Shell& half) {
    const Field belowBelt = below(0.962f, -0.02f);
    // Gaps of doors, bonnet and hatch, before everything that lies over them.
    addGap(
        half,
        both(inSideView(
                 Outline(
                     {{.74f, .255f}, {.80f, .50f}, {.76f, .93f}, {.60f, 1.1f}, {-.37f, 1.1f}, {-.37f, .255f}},
                     .06f),
                 .5f, 0),
             belowBelt));
    addGap(half, both(inSideView(Outline({{{-.37f, .255f}, .03f},
                                          {{-.37f, 1.1f}, .03f},
                                          {{-1.32f, 1.1f}, .05f},
                                          {{-1.26f, .80f}, .2f},
                                          {{-.92f, .60f}, .12f},
                                          {{-.88f, .255f}, .06f}}),
                                 .5f, 0),
                      belowBelt));
    addGap(half,
           inTopView(
               Outline(
                   {{1.02f, -.2f}, {.92f, .60f}, {.80f, .705f}, {1.70f, .640f}, {2.00f, .52f}, {2.06f, -.2f}},
                   .05f),
               .70f));
    addGap(half,
           inRearView(
               Outline({{-.2f, 1.55f}, {.60f, 1.55f}, {.66f, .98f}, {.60f, .60f}, {.55f, .50f}, {-.2f, .50f}},
                       .06f),
               -1.5f));
    // Lower cladding.
    half.assign(below(.285f), Surface::trim);

    // Windows.
    addGlass(
        half,
        inFrontView(Outline({{-.3f, 1.035f}, {.60f, 1.035f}, {.53f, 1.375f}, {-.3f, 1.395f}}, .06f), -.12f));
    const Field daylight = inSideView(Outline({{{.66f, .978f}, .03f},
                                               {{.05f, 1.325f}, .08f},
                                               {{-.40f, 1.362f}, .2f},
                                               {{-1.05f, 1.335f}, .2f},
                                               {{-1.36f, 1.23f}, .1f},
                                               {{-1.46f, 1.025f}, .05f}}),
                                      .4f, .93f);
    half.refine(daylight, 0.035f);
    half.assign(grown(daylight, .010f), Surface::trim);
    addPanel(half,
             inSideView(Outline({{.60f, .958f}, {.60f, .970f}, {-1.42f, 1.016f}, {-1.42f, 1.002f}}, .004f),
                        .4f, .9f),
             Surface::chrome);
    addGlass(half,
             inSideView(Outline({{{.60f, .995f}, .02f},
                                 {{.04f, 1.312f}, .06f},
                                 {{-.325f, 1.345f}, .03f},
                                 {{-.325f, .999f}, .02f}}),
                        .4f, .93f),
             .004f);
    addGlass(half,
             inSideView(Outline({{{-.415f, 1.000f}, .02f},
                                 {{-.415f, 1.345f}, .03f},
                                 {{-1.02f, 1.320f}, .06f},
                                 {{-1.10f, 1.02f}, .02f}}),
                        .4f, .93f),
             .004f);
    addGlass(half,
             inSideView(Outline({{{-1.135f, 1.02f}, .02f},
                                 {{-1.06f, 1.312f}, .03f},
                                 {{-1.31f, 1.22f}, .08f},
                                 {{-1.41f, 1.035f}, .03f}}),
                        .4f, .93f),
             .004f);
    addGlass(half, inRearView(Outline({{-.3f, 1.060f}, {.55f, 1.060f}, {.50f, 1.310f}, {-.3f, 1.330f}}, .07f),
                              -1.60f));

    // Front: lamps, grille, intake, plate.
    addPanel(half,
             roundTheFront(Outline({{{.47f, .640f}, .03f},
                                    {{.86f, .660f}, .05f},
                                    {{1.02f, .745f}, .04f},
                                    {{.60f, .735f}, .05f}}),
                           2.02f),
             Surface::headLamp, .008f);
    addPanel(half,
             inFrontView(Outline({{-.2f, .640f}, {.42f, .645f}, {.44f, .700f}, {-.2f, .705f}}, .02f), 1.7f),
             Surface::trim, .012f, Surface::chrome);
    addPanel(half,
             inFrontView(Outline({{-.2f, .300f}, {.50f, .300f}, {.56f, .420f}, {-.2f, .430f}}, .04f), 1.7f),
             Surface::trim);
    addPanel(half,
             inFrontView(Outline({{-.2f, .455f}, {.26f, .455f}, {.26f, .565f}, {-.2f, .565f}}, .01f), 1.7f),
             Surface::rim, .006f);

    // Rear: lamps, plate, bumper insert.
    addPanel(
        half,
        roundTheRear(
            Outline(
                {{{.50f, .780f}, .03f}, {{.50f, .905f}, .03f}, {{.98f, .935f}, .04f}, {{.93f, .760f}, .05f}}),
            -1.93f),
        Surface::tailLamp, .006f);
    addPanel(half, inRearView(Outline({{-.2f, .20f}, {.60f, .20f}, {.56f, .40f}, {-.2f, .40f}}, .04f), -1.7f),
             Surface::trim);
    addPanel(half,
             inRearView(Outline({{-.2f, .640f}, {.26f, .640f}, {.26f, .750f}, {-.2f, .750f}}, .01f), -1.7f),
             Surface::rim, .02f);
}

}  // namespace

VehicleModel hatchback() {
    Assembly plan{.name = "hatchback",
                  .length = 4.10f,
                  .width = 1.76f,
                  .height = 1.47f,
                  .track = 1.53f,
                  .wheel = {.radius = .315f, .width = .205f, .rimRadius = .212f, .spokes = 5},
                  .axles = {front, rear}};
    Shell half = subdivide(
        cage(), {.rear = -1.995f, .front = 2.105f, .width = plan.width, .floor = .18f, .top = plan.height},
        2);
    city::Mesh parts;
    drawLines(half);
    for (const float x : {front, rear})
        cutWheelArch(half, parts, {.x = x, .z = plan.wheel.radius + .01f, .radius = .362f, .inner = .52f});
    addDoorMirror(parts, {.58f, sideAt(half, .58f, .96f), 1.0f});
    for (const float x : {-.24f, -1.06f}) addHandle(parts, {x, sideAt(half, x, .80f), .80f});
    return assemble(plan, std::move(half), parts, {});
}

}  // namespace vehicles
