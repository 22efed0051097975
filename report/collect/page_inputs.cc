// SPDX-License-Identifier: Apache-2.0
#include "report/collect/page_inputs.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "report/collect/file_hash.h"
#include "report/collect/frame_source.h"

namespace sextant {
namespace {

struct InputFile {
  std::string role;
  std::string path;
};

std::vector<InputFile> FilesOf(const CalibrationResult& result, const Calibration* calibration) {
  std::vector<InputFile> files;
  const auto add = [&](std::string role, const std::string& path) {
    if (!path.empty()) files.push_back({std::move(role), path});
  };
  if (calibration != nullptr) {
    const Session& session = calibration->observed.session;
    add("boards", session.boards.string());
    add("camera", session.camera.string());
    add("recording", session.bag.string());
  }
  for (const ResultView& view : result.views) {
    add("photo of view " + view.name, view.image_path);
    add("scan of view " + view.name, view.cloud_path);
  }
  return files;
}

}  // namespace

PageInputs InputsOf(const CalibrationResult& result, const Calibration* calibration,
                    const std::filesystem::path& folder) {
  const std::vector<InputFile> files = FilesOf(result, calibration);
  std::vector<std::string> hashes(files.size());
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    hashes[i] = HashOfFile(FoundFrom(folder, files[i].path)).value_or("not a readable file");
  });
  PageTable table{.header = {"Input", "File", "SHA-256"}, .words = 3};
  std::string all;
  for (std::size_t i = 0; i < files.size(); ++i) {
    table.rows.push_back({files[i].role, files[i].path, hashes[i]});
    all += hashes[i] + "\n";
  }
  if (files.empty()) {
    table.note = "The result names no files.";
    return {.files = std::move(table)};
  }
  std::string hash = HashOfBytes(all);
  table.note =
      fmt::format("All of them together: SHA-256 {} of the column above, a line each.", hash);
  return {.files = std::move(table), .hash = std::move(hash)};
}

}  // namespace sextant
