#include "app/panel/Panel.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "app/panel/Controls.h"

namespace app {

namespace {

constexpr float panelWidth = 330;
constexpr float waitingWidth = 480;

void beginFrame() {
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
}

void endFrame() {
    ImGui::Render();
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

/// A combo box over the names of an enumeration.
template <typename Enum, std::size_t count>
bool combo(const char* label, const std::array<std::string_view, count>& names, Enum& value) {
    bool changed = false;
    if (ImGui::BeginCombo(label, std::string(names[static_cast<std::size_t>(value)]).c_str())) {
        for (std::size_t i = 0; i < count; ++i)
            if (ImGui::Selectable(std::string(names[i]).c_str(), i == static_cast<std::size_t>(value))) {
                value = static_cast<Enum>(i);
                changed = true;
            }
        ImGui::EndCombo();
    }
    return changed;
}

constexpr std::array<std::string_view, 4> cameraNames{"shots", "tour", "follow", "fly"};

void row(const char* name, const char* format, double value) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::Text(format, value);
}

void drawHelp(PanelChoices& choices) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::Begin("Keys and mouse", &choices.showHelp,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse);
    if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const KeyHelp& help : keyHelp()) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextColored({1, 0.85f, 0.4f, 1}, "%s", help.key.c_str());
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(help.what.c_str());
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

void drawFrameTimes(std::span<const float> frameMs) {
    if (frameMs.empty()) return;
    float highest = 0;
    for (float ms : frameMs) highest = std::max(highest, ms);
    char overlay[64];
    std::snprintf(overlay, sizeof overlay, "%.1f ms", static_cast<double>(frameMs.back()));
    ImGui::PlotLines("##frames", frameMs.data(), static_cast<int>(frameMs.size()), 0, overlay, 0,
                     1.2f * highest, {ImGui::GetContentRegionAvail().x, 60});
}

void drawMap(const PanelNews& news, PanelChoices& choices) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x - 12, screen.y - 12}, ImGuiCond_FirstUseEver, {1, 1});
    ImGui::SetNextWindowSize({430, 385}, ImGuiCond_FirstUseEver);
    ImGui::Begin("What am I seeing?", &choices.showMap, ImGuiWindowFlags_NoCollapse);
    if (news.mapTexture == 0) {
        ImGui::TextWrapped("%s", news.followed.empty()
                                     ? "Follow a vehicle (C, Tab) to see its local map."
                                     : "The followed vehicle has no local map: the method gives it none.");
        ImGui::End();
        return;
    }
    ImGui::Text("Local map of the %s: 6 x %d x %d texels", news.followed.c_str(), news.mapFaceSize,
                news.mapFaceSize);
    ImGui::SameLine();
    ImGui::Checkbox("mesh", &choices.showMesh);
    const float width = ImGui::GetContentRegionAvail().x;
    const ImVec2 size{width, width * static_cast<float>(mapViewFaces.y) / static_cast<float>(mapViewFaces.x)};
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    // OpenGL's first row is the bottom one.
    ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(news.mapTexture)), size, {0, 1},
                 {1, 0});
    if (choices.showMesh) {
        ImDrawList* lines = ImGui::GetWindowDrawList();
        for (const MapLine& line : news.mesh)
            lines->AddLine({corner.x + line.from.x * size.x, corner.y + line.from.y * size.y},
                           {corner.x + line.to.x * size.x, corner.y + line.to.y * size.y},
                           IM_COL32(255, 210, 60, 110));
    }
    ImGui::End();
}

}  // namespace

struct Panel::Impl {
    // Sliders that are costly to obey are obeyed when they are let go.
    int cars = -1;
    float hour = -1;

    void drawSettings(const PanelNews& news, PanelChoices& choices);
    void drawBudget(const PanelNews& news, DriveSettings& settings);
    void drawMirrors(const PanelNews& news, DriveSettings& settings);
    void drawChrome(const PanelNews& news, DriveSettings& settings);
    void drawCounters(const PanelNews& news);

    float budget = -1;
};

void Panel::Impl::drawSettings(const PanelNews& news, PanelChoices& choices) {
    DriveSettings& settings = choices.settings;
    combo("reflections", reflectionMethodNames, settings.method);
    if (settings.method == ReflectionMethod::mem) combo("form of mem", memVariantNames, settings.mem);
    combo("quality", qualityNames, settings.quality);
    if (cars < 0) cars = static_cast<int>(settings.cars);
    ImGui::SliderInt("cars", &cars, 0, 300, "%d", ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemDeactivatedAfterEdit())
        settings.cars = static_cast<std::uint32_t>(cars);
    else if (!ImGui::IsItemActive())
        cars = static_cast<int>(settings.cars);
    if (hour < 0) hour = static_cast<float>(settings.hour);
    ImGui::SliderFloat("hour", &hour, 0, 24, "%.1f", ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemDeactivatedAfterEdit())
        settings.hour = static_cast<double>(hour);
    else if (!ImGui::IsItemActive())
        hour = static_cast<float>(settings.hour);
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("Another light needs other reference maps: this may take a while the first time.");
    ImGui::Checkbox("exposure follows the light", &settings.adapt);

    if (settings.method == ReflectionMethod::mem && settings.mem == MemVariant::ours)
        drawBudget(news, settings);

    combo("camera", cameraNames, choices.camera);
    if (!news.followed.empty()) {
        if (ImGui::ArrowButton("before", ImGuiDir_Left)) choices.nextVehicle = -1;
        ImGui::SameLine();
        if (ImGui::ArrowButton("next", ImGuiDir_Right)) choices.nextVehicle = 1;
        ImGui::SameLine();
        ImGui::Text("following a %s", news.followed.c_str());
    }
    ImGui::Checkbox("pause", &choices.paused);
    ImGui::SameLine();
    ImGui::Checkbox("what am I seeing?", &choices.showMap);
    if (ImGui::Button("screenshot")) choices.screenshot = true;
    ImGui::SameLine();
    if (ImGui::Button("help (F1)")) choices.showHelp = !choices.showHelp;
}

void Panel::Impl::drawBudget(const PanelNews& news, DriveSettings& settings) {
    bool held = settings.budgetMs > 0;
    if (ImGui::Checkbox("hold a budget", &held)) {
        settings.budgetMs = held ? std::max(static_cast<double>(budget), 16.0) : 0;
        if (held) settings.error = 0;
        budget = static_cast<float>(settings.budgetMs);
    }
    if (settings.budgetMs > 0) {
        if (budget <= 0) budget = static_cast<float>(settings.budgetMs);
        ImGui::SliderFloat("ms a frame", &budget, 2, 100, "%.1f",
                           ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
        if (ImGui::IsItemDeactivatedAfterEdit())
            settings.budgetMs = static_cast<double>(budget);
        else if (!ImGui::IsItemActive())
            budget = static_cast<float>(settings.budgetMs);
    }
    if (news.ladder.empty()) return;
    ImGui::TextWrapped("predicted %.1f ms, actual %.1f ms; FLIP %.3f", news.predictedMs, news.actualMs,
                       news.predictedError);
    ImGui::TextWrapped("given up: %s", news.givenUp.empty() ? "nothing" : news.givenUp.c_str());
    if (news.ladder.size() < 2 || !ImGui::TreeNode("as calibrated")) return;
    if (ImGui::BeginTable("ladder", 4, ImGuiTableFlags_SizingStretchProp)) {
        for (const char* head : {"", "ms", "FLIP", "beside"}) ImGui::TableSetupColumn(head);
        ImGui::TableHeadersRow();
        for (std::size_t i = 0; i < news.ladder.size(); ++i) {
            const Rung& rung = news.ladder[i];
            const bool here = std::abs(news.position - static_cast<double>(i)) <= 0.5;
            row(here ? ">" : "", "%.1f", rung.ms());
            for (const double value : {rung.error, rung.pictureError}) {
                ImGui::TableNextColumn();
                ImGui::Text("%.4f", value);
            }
        }
        ImGui::EndTable();
    }
    ImGui::TreePop();
}

void Panel::Impl::drawMirrors(const PanelNews& news, DriveSettings& settings) {
    if (!ImGui::CollapsingHeader("windows")) return;
    ImGui::Checkbox("mirror the street", &settings.mirrors);
    if (!settings.mirrors) return;
    combo("weather", weatherNames, settings.weather);
    ImGui::SliderInt("in a row", &settings.mirrorDepth, 0, 8, "%d", ImGuiSliderFlags_AlwaysClamp);
    int maps = static_cast<int>(settings.mirrorMaps);
    ImGui::SliderInt("maps a frame", &maps, 0, 64, "%d", ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemEdited()) settings.mirrorMaps = static_cast<std::uint32_t>(maps);
    auto fade = static_cast<float>(settings.mirrorFade);
    ImGui::SliderFloat("fade over, m", &fade, 0, 200, fade > 0 ? "%.0f" : "not",
                       ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemEdited()) settings.mirrorFade = fade < 0.5f ? 0.0 : static_cast<double>(fade);
    if (!ImGui::BeginTable("windows", 2, ImGuiTableFlags_SizingStretchProp)) return;
    const MirrorCounters& m = news.mirrors;
    row("fronts in the city", "%.0f", m.inCity);
    row("  near", "%.0f", m.inReach);
    row("  in view", "%.0f", m.inView);
    row("  mirrored", "%.0f", m.shown);
    row("panes", "%.0f", m.windows);
    row("reflections drawn", "%.0f", m.passes);
    row("  saved by sharing", "%.0f", m.shared);
    row("  hidden", "%.0f", m.occluded);
    row("  seen from behind", "%.0f", m.backFacing);
    row("  out of view", "%.0f", m.offScreen);
    row("  too dim", "%.0f", m.belowCutOff);
    row("  beyond the cap", "%.0f", m.overCap);
    row("maps kept", "%.0f", m.levels);
    row("  texels", "%.0f", static_cast<double>(m.texels));
    row("  MiB", "%.1f", static_cast<double>(news.drawn.mirrorTextureBytes) / (1024.0 * 1024.0));
    row("triangles in them", "%.0f", static_cast<double>(news.drawn.mirrorTriangles));
    row("planning, ms", "%.2f", m.milliseconds);
    ImGui::EndTable();
}

void Panel::Impl::drawChrome(const PanelNews& news, DriveSettings& settings) {
    if (!ImGui::CollapsingHeader("chrome")) return;
    ImGui::Checkbox("show what is close", &settings.chrome);
    if (!settings.chrome) return;
    auto share = static_cast<float>(settings.chromeShare);
    ImGui::SliderFloat("searched at most", &share, 0, 1, share > 0 ? "%.3f" : "as it takes",
                       ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemEdited()) settings.chromeShare = static_cast<double>(share);
    ImGui::SliderInt("bounces", &settings.chromeBounces, 1, mostChromeBounces, "%d",
                     ImGuiSliderFlags_AlwaysClamp);
    if (!ImGui::BeginTable("chrome", 2, ImGuiTableFlags_SizingStretchProp)) return;
    const ChromeCounts& c = news.drawn.chrome;
    row("parts of vehicles in view", "%.0f", news.chromeParts);
    row("  that show what is close", "%.0f", c.jobs);
    row("    drawn anew", "%.0f", c.drawn);
    row("  left out for want of room", "%.0f", news.chromeLeftOut);
    row("  whose reflectors are being made", "%.0f", news.chromeMaking);
    const ChromeBounceCounts& b = c.bounces;
    row("chrome parts close to them", "%.0f", b.parts);
    row("  in pictures of what they mirror", "%.0f", b.pictures);
    row("    drawn anew", "%.0f", b.drawn);
    row("    coming or going", "%.0f", b.fading);
    row("  too small in them", "%.0f", b.tooSmall);
    row("  not seen in them", "%.0f", b.unseen);
    row("  too bent, or too near", "%.0f", b.tooBent + b.tooNear);
    row("  left out for want of room", "%.0f", b.overCap);
    row("  whose reflectors are being made", "%.0f", b.making);
    row("  ms", "%.2f", b.milliseconds);
    row("meshes in them", "%.0f", c.meshes);
    row("  left out: hidden, far, too small", "%.0f", c.leftOut);
    row("  triangles", "%.0f", static_cast<double>(c.triangles));
    row("  vertices", "%.0f", static_cast<double>(c.vertices));
    row("  searched", "%.0f", static_cast<double>(c.searched));
    row("searching, ms", "%.2f", c.searchMilliseconds);
    row("in all, ms", "%.2f", c.milliseconds);
    row("MiB", "%.1f", static_cast<double>(news.drawn.chromeTextureBytes) / (1024.0 * 1024.0));
    row("  of reflectors", "%.1f", static_cast<double>(news.chromeBytes) / (1024.0 * 1024.0));
    ImGui::EndTable();
}

void Panel::Impl::drawCounters(const PanelNews& news) {
    if (!ImGui::BeginTable("counters", 2, ImGuiTableFlags_SizingStretchProp)) return;
    constexpr double mebi = 1024.0 * 1024.0;
    row("vehicles", "%.0f", static_cast<double>(news.vehicles));
    row("  in view", "%.0f", news.reflections.visible);
    row("local maps rebuilt", "%.0f", news.reflections.rebuilt);
    row("  still good", "%.0f", news.reflections.fresh);
    row("  a neighbour's", "%.0f", news.reflections.shared);
    row("  left for later", "%.0f", news.reflections.postponed);
    row("  rays", "%.0f", static_cast<double>(news.reflections.rays));
    row("  texels", "%.0f", static_cast<double>(news.reflections.texels));
    row("reflections, ms", "%.2f", news.reflections.milliseconds);
    row("local maps, MiB", "%.1f", static_cast<double>(news.reflections.localMapBytes) / mebi);
    row("reference maps, MiB", "%.1f", static_cast<double>(news.reflections.referenceMapBytes) / mebi);
    row("  on the GPU", "%.1f", static_cast<double>(news.reflections.referenceMapGpuBytes) / mebi);
    row("triangles drawn", "%.0f", static_cast<double>(news.drawn.triangles));
    row("draw calls", "%.0f", news.drawn.drawCalls);
    row("chunks culled", "%.0f", news.drawn.chunksCulled);
    ImGui::EndTable();
}

Panel::Panel(Window& window) : impl_(std::make_unique<Impl>()) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // leaves no file in whatever folder the program was started from
    ImGui::StyleColorsDark();
    ImGui::GetStyle().WindowRounding = 6;
    ImGui_ImplGlfw_InitForOpenGL(window.handle(), true);
    ImGui_ImplOpenGL3_Init("#version 450 core");
}

Panel::~Panel() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

bool Panel::takesMouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}
bool Panel::takesKeys() const {
    return ImGui::GetIO().WantTextInput;
}

void Panel::draw(const PanelNews& news, PanelChoices& choices) {
    choices.nextVehicle = 0;
    choices.screenshot = false;
    beginFrame();
    if (choices.showPanel) {
        ImGui::SetNextWindowPos({12, 12}, ImGuiCond_FirstUseEver);
        ImGui::SetNextWindowSize({panelWidth, 0}, ImGuiCond_FirstUseEver);
        ImGui::Begin("mirrorstreet", &choices.showPanel);
        drawFrameTimes(news.frameMs);
        impl_->drawSettings(news, choices);
        impl_->drawMirrors(news, choices.settings);
        impl_->drawChrome(news, choices.settings);
        ImGui::Separator();
        impl_->drawCounters(news);
        ImGui::TextDisabled("%s", news.renderer.c_str());
        ImGui::End();
    }
    if (choices.showMap) drawMap(news, choices);
    if (choices.showHelp) drawHelp(choices);
    endFrame();
}

void Panel::drawWaiting(const Waiting& waiting) {
    beginFrame();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    // A height of its own: a window that is fitted to its text is hidden in its first frame.
    const float lines = 2.5f + (waiting.total > 0 ? 1.0f : 0.0f);
    ImGui::SetNextWindowSize({std::min(waitingWidth, screen.x), lines * ImGui::GetFrameHeightWithSpacing()});
    ImGui::Begin("##waiting", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs);
    ImGui::TextWrapped("%s", waiting.what.c_str());
    if (waiting.total > 0) {
        const std::string count = std::to_string(waiting.done) + " of " + std::to_string(waiting.total);
        ImGui::ProgressBar(static_cast<float>(waiting.done) / static_cast<float>(waiting.total), {-1, 0},
                           count.c_str());
    }
    if (!waiting.remark.empty()) ImGui::TextDisabled("%s", waiting.remark.c_str());
    ImGui::End();
    endFrame();
}

}  // namespace app
