// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/run/part_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>
#include <system_error>

#include "eval/experiment/run/row_file.h"

namespace sextant {
namespace {

constexpr const char* kWholeFile = "rows.sxtrows";

bool IsPartFile(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with("shard_") && name.ends_with(".sxtrows") &&
         name.find("_of_") != std::string::npos;
}

std::vector<std::filesystem::path> AllRowFiles(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::filesystem::path& path = it->path();
    if (path.filename() == kWholeFile || IsPartFile(path)) files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Whether the file contains only the beginning of a header, from a run that was killed.
bool HoldsNothing(const std::filesystem::path& path, const std::string& configuration) {
  const std::string header = RowFileHeader(configuration);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size >= header.size()) return false;
  std::string begun(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(begun.data(), static_cast<std::streamsize>(size));
  return stream && header.starts_with(begun);
}

tl::unexpected<Error> Failed(const char* what, const std::filesystem::path& path,
                             const std::error_code& error) {
  return MakeError(ErrorCode::kIo,
                   fmt::format("cannot {} '{}': {}", what, path.string(), error.message()));
}

}  // namespace

std::string PartFileName(const Shard& shard) {
  return fmt::format("shard_{}_of_{}.sxtrows", shard.number + 1, shard.of);
}

std::vector<std::filesystem::path> RowFilesIn(const std::filesystem::path& folder,
                                              const std::string& configuration) {
  std::vector<std::filesystem::path> files = AllRowFiles(folder);
  std::erase_if(
      files, [&](const std::filesystem::path& path) { return HoldsNothing(path, configuration); });
  return files;
}

Expected<std::vector<std::uint64_t>> BlocksHeldBy(const std::vector<std::filesystem::path>& files,
                                                  const std::string& configuration) {
  std::vector<std::uint64_t> blocks;
  for (const std::filesystem::path& path : files) {
    SEXTANT_ASSIGN_OR_RETURN(const RowFileReader reader, RowFileReader::Open(path));
    if (reader.configuration() != configuration) {
      return MakeError(
          ErrorCode::kInvalidInput,
          fmt::format("'{}' holds the rows of another configuration of the experiment; start over "
                      "with --fresh, or choose another folder with --out",
                      path.string()));
    }
    for (const RowBlockPlace& block : reader.blocks()) blocks.push_back(block.number);
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

Expected<void> RemoveRowFiles(const std::filesystem::path& folder) {
  for (const std::filesystem::path& path : AllRowFiles(folder)) {
    std::error_code error;
    std::filesystem::remove(path, error);
    if (error) return Failed("remove", path, error);
  }
  return {};
}

Expected<void> JoinRowFiles(const std::filesystem::path& folder, const std::string& configuration) {
  const std::vector<std::filesystem::path> files = RowFilesIn(folder, configuration);
  const std::filesystem::path whole = folder / kWholeFile;
  if (files != std::vector<std::filesystem::path>{whole}) {
    const std::filesystem::path joined = folder / "rows.sxtrows.part";
    SEXTANT_RETURN_IF_ERROR(MergeRowFiles(files, joined));
    std::error_code error;
    std::filesystem::rename(joined, whole, error);
    if (error) return Failed("write", whole, error);
  }
  for (const std::filesystem::path& path : AllRowFiles(folder)) {
    std::error_code error;
    if (path != whole) std::filesystem::remove(path, error);
    if (error) return Failed("remove", path, error);
  }
  return {};
}

}  // namespace sextant
