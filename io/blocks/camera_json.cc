// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/camera_json.h"

#include <nlohmann/json.hpp>

#include "io/blocks/camera_block.h"

namespace sextant {

nlohmann::ordered_json CameraJson(const Camera& camera) {
  return {{"model", CameraModelName(camera.model)},
          {"width_px", camera.width_px},
          {"height_px", camera.height_px},
          {"fx_px", camera.fx_px},
          {"fy_px", camera.fy_px},
          {"cx_px", camera.cx_px},
          {"cy_px", camera.cy_px},
          {"distortion", camera.distortion}};
}

}  // namespace sextant
