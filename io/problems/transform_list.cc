// SPDX-License-Identifier: Apache-2.0
#include "io/problems/transform_list.h"

#include <fmt/core.h>

#include "io/blocks/rigid_matrix.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {

Expected<std::vector<Rigid3d>> ReadTransformList(const std::filesystem::path& path) {
  return ReadWith(path, ParseTransformList);
}

Expected<std::vector<Rigid3d>> ParseTransformList(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  std::vector<Rigid3d> transforms;
  do {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 4; ++i) {
      const std::string what = fmt::format("row {} of 4 of a 4x4 matrix", i + 1);
      if (!in.Require(what) || !in.HasFields(4, what)) continue;
      for (int j = 0; j < 4; ++j) matrix(i, j) = in.Real(static_cast<std::size_t>(j));
    }
    const std::optional<Rigid3d> transform = RigidFromMatrix(matrix);
    if (!transform) {
      in.Fail(ErrorCode::kParse,
              "expected a rotation and a translation above the row 0 0 0 1 up to here");
      break;
    }
    transforms.push_back(*transform);
  } while (in.ok() && !in.AtEnd());
  if (!in.ok()) return in.TakeError();
  return transforms;
}

}  // namespace sextant
