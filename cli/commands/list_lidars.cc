// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <numbers>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "eval/statistics/text_table.h"
#include "io/output/standard_output.h"
#include "simulator/lidar/lidar_model.h"

namespace sextant::cli {
namespace {

struct ListLidarsOptions {
  bool markdown = false;
};

void Declare(ListLidarsOptions& options, Arguments& arguments) {
  arguments.Add("--markdown", options.markdown, "For a page");
}

double Degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

std::string FieldOfView(const LidarModel& model) {
  if (model.rosette) {
    return fmt::format("cone of {:.1f}", 4.0 * Degrees(model.rosette->deflection_rad));
  }
  return fmt::format("{:.2f} to {:.2f}", Degrees(model.rings.front().elevation_rad),
                     Degrees(model.rings.back().elevation_rad));
}

TextTable Figures(const std::vector<LidarModel>& models) {
  TextTable table({"model", "rings", "elevations [deg]", "columns", "sigma [mm]",
                   "sigma of ring biases [mm]", "range step [mm]", "spot [mm]", "grows by [mrad]"},
                  TextTable::Columns::kWords);
  for (const LidarModel& model : models) {
    table.AddRow(
        {model.name, model.rosette ? "-" : std::to_string(model.rings.size()), FieldOfView(model),
         std::to_string(ColumnCount(model)), Fixed(1e3 * model.range_sigma_m, 1),
         Fixed(1e3 * model.ring_bias_sigma_m, 1), Fixed(1e3 * model.range_step_m, 0),
         fmt::format("{:.1f} x {:.1f}", 1e3 * model.aperture_h_m, 1e3 * model.aperture_v_m),
         fmt::format("{:.1f} x {:.1f}", 1e3 * model.divergence_h_rad,
                     1e3 * model.divergence_v_rad)});
  }
  return table;
}

TextTable Sources(const std::vector<LidarModel>& models) {
  TextTable table({"model", "is", "source", "not from the source"}, TextTable::Columns::kWords);
  for (const LidarModel& model : models) {
    table.AddRow({model.name, model.title, model.source, model.approximations});
  }
  return table;
}

int Run(const ListLidarsOptions& options) {
  std::vector<LidarModel> models;
  for (const std::string& name : LidarModelNames()) models.push_back(*FindLidarModel(name));
  const auto text = [&options](const TextTable& table) {
    return options.markdown ? table.Markdown() : table.Plain();
  };
  Print("{}\n{}", text(Figures(models)), text(Sources(models)));
  return kAnswered;
}

}  // namespace

Command ListLidarsCommand() {
  return MakeCommand<ListLidarsOptions>("lidars", "The LiDARs that can be simulated",
                                        "Example:\n  sextant list lidars", Declare, Run);
}

}  // namespace sextant::cli
