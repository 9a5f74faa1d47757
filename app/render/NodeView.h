#pragma once

#include <epoxy/gl.h>

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include "app/render/PassTarget.h"
#include "reflection/gl/MirrorScene.h"
#include "reflection/planar/ReflectionTree.h"

namespace app {

/// The state in which views are drawn: reversed depth, fronts counter-clockwise.
inline void setDrawState() {
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GEQUAL);
    glCullFace(GL_BACK);
    glFrontFace(GL_CCW);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

/// The same for a reflection: its part of the target, and the winding that it sees.
inline void setDrawState(const reflection::MirrorTarget& target) {
    setDrawState();
    const glm::ivec2 part = target.scissor.size();
    glScissor(target.scissor.low.x, target.scissor.low.y, part.x, part.y);
    glEnable(GL_SCISSOR_TEST);
    glFrontFace(target.mirrored ? GL_CW : GL_CCW);
}

inline glm::mat4 clipFromRelative(const glm::dmat4& clipFromView, const glm::dmat3& viewFromWorld) {
    return glm::mat4(clipFromView * glm::dmat4(viewFromWorld));
}

/// The eye behind the glass, as far as the glass lets it see; `share`: of the resolution that levels of
/// detail are chosen for. Keeps a pointer into the node.
inline PassView passOf(const reflection::ReflectionNode& node, float share) {
    PassView pass(node.view.eye, clipFromRelative(node.obliqueClipFromView, node.view.viewFromWorld),
                  share * 0.5f * static_cast<float>(node.resolution.y) *
                      std::abs(static_cast<float>(node.clipFromView[1][1])));
    if (!node.frustum.empty()) pass.portal = &node.frustum;
    return pass;
}

}  // namespace app
