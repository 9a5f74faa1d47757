#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "app/render/VertexFormats.h"
#include "reflection/gl/Buffer.h"
#include "reflection/gl/VertexArray.h"
#include "vehicles/models/VehicleModel.h"

namespace app {

/// The vehicle models' meshes on the GPU, in the levels of VehicleLevels: one vertex and one index buffer for
/// all.
class VehicleGeometry {
  public:
    struct Level {
        MeshRange body;
        bool wheelsInBody = false;
        float error = 0;  ///< metres
    };
    struct WheelLevel {
        MeshRange mesh;
        float error = 0;  ///< metres
    };
    struct Model {
        std::vector<Level> levels;
        std::vector<WheelLevel> wheelLevels;  ///< finest first; empty: no wheels of their own
        std::vector<vehicles::VehicleModel::Wheel> wheels;
        glm::vec3 centre{0};  ///< of the bounding box, vehicle frame
        glm::vec3 halfSize{0};
        float radius = 0;  ///< of the bounding sphere around `centre`
    };

    explicit VehicleGeometry(std::span<const vehicles::VehicleModel> models);

    const std::vector<Model>& models() const { return models_; }
    const reflection::gl::VertexArray& array() const { return array_; }
    reflection::gl::Buffer& instances() { return instances_; }

  private:
    std::vector<Model> models_;
    reflection::gl::Buffer vertices_;
    reflection::gl::Buffer indices_;
    reflection::gl::Buffer instances_;
    reflection::gl::VertexArray array_;
};

}  // namespace app
