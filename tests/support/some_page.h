// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/page/page.h"

namespace sextant::test {

/// A report with every part, `text` as each text of others, and so many views, of which the last is
/// left out. Each view has a board, the photo, and 400 returns.
inline ReportPage SomePage(int views, const std::string& text, const std::string& jpeg) {
  ReportPage page{.title = text,
                  .date = text,
                  .version = text,
                  .verdict = {.tone = PageTone::kGood, .word = text, .reason = text, .next = text},
                  .figures = {{text, text, text}, {text, text, text}},
                  .diagnostics = {text, text},
                  .next = {.sentences = {text, text}},
                  .closing = text,
                  .configuration = {text}};
  const Rigid3d cam_from_lidar{Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {0.1, -0.1, 0.05}};
  page.transforms = {{.from = text,
                      .to = text,
                      .to_from_from = cam_from_lidar,
                      .in_words = text,
                      .sigma = Vector6d::Constant(1e-3)}};
  PageSensor camera{.name = text, .is_camera = true, .base_from_sensor = cam_from_lidar.Inverse()};
  camera.frustum = {{-0.3, -0.2, 0.4}, {0.3, -0.2, 0.4}, {0.3, 0.2, 0.4}, {-0.3, 0.2, 0.4}};
  camera.facts = {.rows = {{text, text}}, .words = 2};
  page.sensors = {{.name = text, .base_from_sensor = Rigid3d{}}, camera};
  for (int i = 0; i < views; ++i) {
    const double x = 2.0 + 0.3 * i;
    PageBoard board{.name = text,
                    .by_camera = {{x, 0.3, 0.0}, {x, 0.0, 0.3}, {x, -0.3, 0.0}, {x, 0.0, -0.3}},
                    .by_lidar = {{x, 0.31, 0.0}, {x, 0.0, 0.31}, {x, -0.29, 0.0}, {x, 0.0, -0.3}},
                    .camera_in_px = {{100, 100}, {200, 100}, {200, 200}, {100, 200}},
                    .lidar_in_px = {{102, 100}, {201, 101}, {200, 200}, {100, 203}},
                    .residuals_m = {0.001, 0.002, 0.003, 0.004},
                    .residuals_px = {0.1, 0.2, 0.3, 0.4},
                    .range_m = x};
    PageView view{.name = text,
                  .is_kept = i + 1 < views,
                  .reason = i + 1 < views ? "" : text,
                  .time = text,
                  .rmse_m = 0.0025,
                  .rmse_px = 0.3,
                  .held_out_m = 0.003,
                  .sigma_so_far = Vector6d::Constant(1e-3),
                  .boards = {board},
                  .photo = PagePhoto{.jpeg = jpeg, .width_px = 640, .height_px = 480},
                  .scan = PageScan{.returns = 400},
                  .no_photo = text};
    for (int k = 0; k < 400; ++k) {
      const auto y = static_cast<float>(-1.0 + 0.1 * (k % 20));
      const auto z = static_cast<float>(-1.0 + 0.1 * (k / 20));
      view.scan->in_base.emplace_back(static_cast<float>(x), y, z);
      view.scan->intensity.push_back(static_cast<std::uint8_t>(k % 256));
      view.scan->colour.push_back({static_cast<std::uint8_t>(k % 256), 128, 10});
      view.photo->dots.push_back(
          {{10.0F + 30.0F * static_cast<float>(k % 20), 12.5F * static_cast<float>(k / 20)},
           static_cast<float>(k) / 400.0F});
    }
    page.views.push_back(view);
  }
  const PagePlot plot{.title = text,
                      .x_label = text,
                      .y_label = text,
                      .series = {{text, {{1.0, 2.0}, {2.0, 3.5}}, true}, {text, {{1.5, 1.0}}}},
                      .note = text};
  page.coverage = {{.camera = text,
                    .width_px = 640,
                    .height_px = 480,
                    .outlines = {{{100, 100}, {200, 100}, {200, 200}, {100, 200}}},
                    .share = 0.25}};
  page.coverage_plots = page.residual_plots = page.sigma_plots = {plot};
  const PageTable table{.header = {text, text}, .rows = {{text, text}}, .note = text};
  page.sigmas = page.noise = page.comparison = page.inputs.files = table;
  page.sigma_text = text;
  page.correlation =
      PageCorrelation{.names = {text, text}, .values = Eigen::MatrixXd::Identity(2, 2)};
  return page;
}

}  // namespace sextant::test
