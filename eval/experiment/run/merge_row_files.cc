// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <system_error>

#include "eval/experiment/run/configuration.h"
#include "eval/experiment/run/part_files.h"
#include "eval/experiment/run/row_file.h"
#include "eval/experiment/run/run_trials.h"
#include "io/output/output_file.h"

namespace sextant {
namespace {

struct Piece {
  std::size_t file = 0;
  RowBlockPlace place;
};

Expected<std::vector<RowFileReader>> OpenAll(const std::vector<std::filesystem::path>& shards,
                                             const std::string& configuration) {
  std::vector<RowFileReader> readers;
  for (const std::filesystem::path& path : shards) {
    SEXTANT_ASSIGN_OR_RETURN(RowFileReader reader, RowFileReader::Open(path));
    if (!readers.empty() && reader.configuration() != readers[0].configuration()) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("'{}' holds the rows of another experiment than '{}'",
                                   path.string(), shards[0].string()));
    }
    readers.push_back(std::move(reader));
  }
  if (readers[0].configuration() == configuration) return readers;
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("'{}' holds the rows of another configuration; name the experiment "
                               "and give the options with which the shards were run",
                               shards[0].string()));
}

// Rows of the same configuration may be replaced, whoever wrote them; others on demand only.
Expected<Replace> HowToReplace(const std::filesystem::path& merged,
                               const std::string& configuration) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::symlink_status(merged, error);
  if (!std::filesystem::is_regular_file(status)) return Replace::kOwnFiles;
  if (HoldsNothing(merged, configuration)) return Replace::kAnyFile;
  if (const CallFiles* const call = CallFiles::Current();
      call != nullptr && call->may_overwrite()) {
    return Replace::kAnyFile;
  }
  const Expected<RowFileReader> existing = RowFileReader::Open(merged);
  if (existing && existing->configuration() == configuration) return Replace::kAnyFile;
  return MakeError(
      ErrorCode::kInvalidInput,
      fmt::format("'{}' is not replaced: {}; choose another folder with --out, or replace it with "
                  "--overwrite",
                  merged.string(),
                  existing ? "it holds the rows of another experiment" : existing.error().message));
}

// All distinct blocks by number. Errors: kInvalidInput if one is missing.
Expected<std::vector<Piece>> SortPieces(const std::vector<RowFileReader>& readers) {
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < readers.size(); ++i) {
    for (const RowBlockPlace& place : readers[i].blocks()) pieces.push_back({i, place});
  }
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const Piece& a, const Piece& b) { return a.place.number < b.place.number; });
  const auto same = [](const Piece& a, const Piece& b) { return a.place.number == b.place.number; };
  pieces.erase(std::unique(pieces.begin(), pieces.end(), same), pieces.end());
  const std::uint64_t expected = CountBlocks(readers[0].configuration());
  if (pieces.size() == expected) return pieces;
  std::uint64_t missing = 0;
  while (missing < pieces.size() && pieces[missing].place.number == missing) ++missing;
  std::string damage;
  for (const RowFileReader& reader : readers) {
    for (const std::string& line : DescribeDamage(reader)) damage += line + "; ";
  }
  return MakeError(
      ErrorCode::kInvalidInput,
      fmt::format(
          "{}{} of {} blocks are in none of the files, the first is number {}; {}finish all "
          "shards and name all of them",
          damage, expected - pieces.size(), expected, missing,
          damage.empty() ? "" : "run the damaged ones again, which repairs them, "));
}

// Writes the pieces, in their order, to the file.
Expected<void> WritePieces(const std::vector<RowFileReader>& readers,
                           const std::vector<Piece>& pieces, OutputFile file) {
  SEXTANT_RETURN_IF_ERROR(file.Append(RowFileHeader(readers.front().configuration())));
  for (const Piece& piece : pieces) {
    SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, readers[piece.file].ReadBytes(piece.place));
    SEXTANT_RETURN_IF_ERROR(file.Append(bytes));
  }
  return file.Commit();
}

}  // namespace

Expected<void> MergeRowFiles(const std::vector<std::filesystem::path>& shards,
                             const std::filesystem::path& merged, const std::string& configuration,
                             OutputUse use) {
  if (shards.empty()) return MakeError(ErrorCode::kMissingData, "no row files to merge");
  for (const std::filesystem::path& shard : shards) {
    std::error_code ignored;
    if (use.may_be_read || !std::filesystem::equivalent(shard, merged, ignored)) continue;
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("'{}' is itself one of the files to merge; name another folder",
                                 merged.string()));
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<RowFileReader> readers,
                           OpenAll(shards, configuration));
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<Piece> pieces, SortPieces(readers));
  SEXTANT_ASSIGN_OR_RETURN(const Replace replace, HowToReplace(merged, configuration));
  // The file that is replaced was read above.
  SEXTANT_ASSIGN_OR_RETURN(OutputFile file,
                           OutputFile::Open(merged, replace, {.may_be_read = true}));
  return WritePieces(readers, pieces, std::move(file));
}

Expected<void> OrderRowFile(const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(RowFileReader reader, RowFileReader::Open(path));
  std::vector<Piece> pieces;
  for (const RowBlockPlace& place : reader.blocks()) pieces.push_back({0, place});
  std::vector<RowFileReader> readers;
  readers.push_back(std::move(reader));
  SEXTANT_ASSIGN_OR_RETURN(
      OutputFile file,
      OutputFile::Open(path, Replace::kAnyFile, {.may_be_read = true, .is_repeated = true}));
  return WritePieces(readers, pieces, std::move(file));
}

}  // namespace sextant
