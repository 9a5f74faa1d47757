// Cubes are drawn as OpenGL samples them, with true distances.
#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "app/display/OffscreenContext.h"
#include "app/frame/Sky.h"
#include "app/render/SceneRenderer.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/DebugOutput.h"
#include "reflection/gl/Texture.h"
#include "tests/app/render/BoxWorld.h"

namespace app {
namespace {

namespace gl = reflection::gl;

/// What a cube array's samplers return in some directions (nearest texel of level 0).
std::vector<glm::vec4> sampleCube(GLuint texture, int cube, const std::vector<glm::vec4>& directions) {
    const char* text = R"(#version 450 core
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer In { vec4 directions[]; };
layout(std430, binding = 1) writeonly buffer Out { vec4 values[]; };
layout(binding = 0) uniform samplerCubeArray cubes;
uniform float cube;
void main() { values[gl_GlobalInvocationID.x] = textureLod(cubes, vec4(directions[gl_GlobalInvocationID.x].xyz, cube), 0.0); })";
    const GLuint program = glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &text);
    auto in = gl::Buffer::filled(std::span<const glm::vec4>(directions));
    auto out = gl::Buffer::create();
    std::vector<glm::vec4> values(directions.size());
    out.replace(std::span<const glm::vec4>(values));
    const auto nearest = gl::Sampler::create(GL_NEAREST, GL_NEAREST, GL_CLAMP_TO_EDGE);
    glBindTextureUnit(0, texture);
    nearest.bind(0);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out.name());
    glProgramUniform1f(program, glGetUniformLocation(program, "cube"), static_cast<float>(cube));
    glUseProgram(program);
    glDispatchCompute(static_cast<GLuint>(directions.size()), 1, 1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    glGetNamedBufferSubData(out.name(), 0, static_cast<GLsizeiptr>(values.size() * sizeof(glm::vec4)),
                            values.data());
    glBindSampler(0, 0);
    glUseProgram(0);
    glDeleteProgram(program);
    return values;
}

class DrawCubeGlTest : public testing::Test {
  public:
    ~DrawCubeGlTest() override { EXPECT_THAT(debug_.errors(), testing::IsEmpty()); }

  protected:
    OffscreenContext context_;
    gl::DebugOutput debug_;
    std::vector<vehicles::VehicleModel> models_{test::boxCar()};
};

TEST_F(DrawCubeGlTest, everyDirectionFindsWhatLiesThere) {
    // Small glowing boxes all around, each of a colour of its own.
    std::mt19937 random(7);
    const auto unit = [&] { return static_cast<float>(random() % 10000) / 5000.f - 1.f; };
    const glm::dvec3 centre(210.5, -73.25, 12.125);
    city::CityModel city;
    std::vector<glm::vec4> directions;
    while (directions.size() < 60) {
        const glm::vec3 d(unit(), unit(), unit());
        const float length = glm::length(d);
        if (length > 1 || length < 0.1f) continue;
        const glm::vec3 direction = d / length;
        bool free = true;
        for (const glm::vec4& other : directions)
            free = free && glm::dot(glm::vec3(other), direction) < 0.95f;
        if (!free) continue;
        city::Material material;
        material.tint = glm::vec3(0);
        material.emission = {0.5f + 0.5f * unit(), 0.5f + 0.5f * unit(), 0.5f + 0.5f * unit()};
        city::Mesh mesh;
        const glm::vec3 at = glm::vec3(centre) + 20.f * direction;
        test::addBox(mesh, at - 1.5f, at + 1.5f, static_cast<std::uint32_t>(city.materials.size()));
        city.materials.push_back(material);
        city.chunks.push_back(test::chunkOf(city::ChunkKind::building, std::move(mesh)));
        directions.emplace_back(direction, 0);
    }
    SceneRenderer renderer(city, models_, {});
    FrameScene scene;
    scene.lighting.lampsLit = true;
    renderer.prepare(scene);

    const int faceSize = 128;
    const auto colour = gl::Texture::cubeArray(GL_RGBA16F, faceSize, 3);
    const auto distance = gl::Texture::cubeArray(GL_R32F, faceSize, 3);
    const float untouched = -7;
    glClearTexImage(distance.name(), 0, GL_RED, GL_FLOAT, &untouched);
    renderer.drawCube(centre, {colour.name(), distance.name(), 1, faceSize}, {});

    const auto colours = sampleCube(colour.name(), 1, directions);
    const auto distances = sampleCube(distance.name(), 1, directions);
    for (std::size_t i = 0; i < directions.size(); ++i) {
        const glm::vec3 wanted = city.materials[i].emission;
        // The plain pattern may vary a little around 1.
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(colours[i][c], wanted[c], 0.12f * wanted[c] + 0.01f) << i;
        EXPECT_GT(distances[i].x, 20 - 1.5f * std::sqrt(3.f) - 0.1f) << i;
        EXPECT_LT(distances[i].x, 20 - 1.4f) << i;
    }
    // Neighbouring cubes are left alone.
    for (int cube : {0, 2})
        for (const glm::vec4& value : sampleCube(distance.name(), cube, directions))
            EXPECT_EQ(value.x, untouched);
}

TEST_F(DrawCubeGlTest, skyIsThatOfTheProcessorAndInfinitelyFar) {
    const city::CityModel city = test::boxCity();
    SceneRenderer renderer(city, models_, {});
    for (double hour : {13.0, 20.0, 1.0}) {
        FrameScene scene;
        scene.lighting = lightingAt(hour);
        renderer.prepare(scene);
        const auto colour = gl::Texture::cubeArray(GL_RGBA32F, 16, 1);
        const auto distance = gl::Texture::cubeArray(GL_R32F, 16, 1);
        renderer.drawCube({0, 0, 2}, {colour.name(), distance.name(), 0, 16}, {false, false, 0});
        std::vector<glm::vec4> directions;
        for (int face = 0; face < 6; ++face) {
            // Texel centres, by the rule of the OpenGL specification.
            for (int t = 0; t < 16; ++t) {
                for (int s = 0; s < 16; ++s) {
                    const float a = (static_cast<float>(s) + 0.5f) / 8 - 1;
                    const float b = (static_cast<float>(t) + 0.5f) / 8 - 1;
                    const glm::vec3 d = face == 0   ? glm::vec3(1, -b, -a)
                                        : face == 1 ? glm::vec3(-1, -b, a)
                                        : face == 2 ? glm::vec3(a, 1, b)
                                        : face == 3 ? glm::vec3(a, -1, -b)
                                        : face == 4 ? glm::vec3(a, -b, 1)
                                                    : glm::vec3(-a, -b, -1);
                    directions.emplace_back(glm::normalize(d), 0);
                }
            }
        }
        const auto colours = sampleCube(colour.name(), 0, directions);
        const auto distances = sampleCube(distance.name(), 0, directions);
        for (std::size_t i = 0; i < directions.size(); ++i) {
            const glm::vec3 wanted = skyRadiance(scene.lighting, glm::vec3(directions[i]));
            // Powers up to 320 magnify rounding of the direction: a few parts in a thousand near the sun.
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(colours[i][c], wanted[c], 0.004f * wanted[c] + 1e-4f)
                    << hour << " h, texel " << i;
            EXPECT_TRUE(std::isinf(distances[i].x) && distances[i].x > 0);
        }
    }
}

TEST_F(DrawCubeGlTest, showsOtherVehiclesButNotItsOwn) {
    city::CityModel city;
    city.materials.emplace_back();
    SceneRenderer renderer(city, models_, {});
    FrameScene scene;
    scene.vehicles.resize(2);
    for (std::uint32_t i = 0; i < 2; ++i) {
        scene.vehicles[i].id = 10 + i;
        scene.vehicles[i].position = {100 + 8.0 * i, 50, 0};
    }
    renderer.prepare(scene);
    const auto colour = gl::Texture::cubeArray(GL_R11F_G11F_B10F, 64, 1);
    const auto distance = gl::Texture::cubeArray(GL_R32F, 64, 1);
    const std::vector<glm::vec4> ahead{{1, 0, 0, 0}, {-1, 0, 0, 0}, {0, 1, 0, 0}, {0, -1, 0, 0}};
    renderer.drawCube({100, 50, 0.6}, {colour.name(), distance.name(), 0, 64}, {true, true, 10});
    const auto seen = sampleCube(distance.name(), 0, ahead);
    EXPECT_NEAR(seen[0].x, 8 - 2.2f, 0.05f);  // the other car's tail
    for (int i = 1; i < 4; ++i) EXPECT_TRUE(std::isinf(seen[static_cast<std::size_t>(i)].x));
    renderer.drawCube({100, 50, 0.6}, {colour.name(), distance.name(), 0, 64}, {true, false, 10});
    EXPECT_TRUE(std::isinf(sampleCube(distance.name(), 0, ahead)[0].x));
}

}  // namespace
}  // namespace app
