#include "app/render/ViewSkylines.h"

#include "app/render/NodeView.h"

namespace app {

namespace {

/// Beams around the eye by which hidden things are left out: 0.35 degrees wide.
constexpr int viewBeams = 1024;

}  // namespace

const SkylineView* ViewSkylines::of(const PassView& view) {
    if (!cull_) return nullptr;
    if (!last_ || lastEye_ != view.eye || lastClip_ != view.clipFromRelative) {
        lastEye_ = view.eye;
        lastClip_ = view.clipFromRelative;
        last_.emplace(skyline_, view.eye, viewBeams, SkylineView::sectorOf(view.clipFromRelative));
    }
    return &*last_;
}

const SkylineView* ViewSkylines::through(const reflection::EyeView& from,
                                         const reflection::HalfSpace* glass) {
    if (!cull_) return nullptr;
    for (const auto& [eye, view] : behindMirrors_)
        if (eye == from.eye) return view.get();
    // A front's image may be seen in all of the whole image.
    const auto sector = SkylineView::sectorOf(clipFromRelative(from.clipFromView, from.viewFromWorld));
    auto made = std::make_unique<SkylineView>(skyline_, from.eye, viewBeams, sector,
                                              glass != nullptr ? *glass : glm::dvec4(0));
    return behindMirrors_.emplace_back(from.eye, std::move(made)).second.get();
}

}  // namespace app
