// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "eval/experiment/run/configuration.h"
#include "eval/experiment/run/row_file.h"
#include "eval/experiment/run/run_trials.h"

namespace sextant {
namespace {

struct Piece {
  std::size_t file = 0;
  RowBlockPlace place;
};

Expected<std::vector<RowFileReader>> OpenAll(const std::vector<std::filesystem::path>& shards) {
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
  return readers;
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

// Writes the pieces, in their order, to a new file.
Expected<void> WritePieces(const std::vector<RowFileReader>& readers,
                           const std::vector<Piece>& pieces, const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(
      RowFileWriter writer,
      RowFileWriter::Open(path, readers.front().configuration(), /*fresh=*/true));
  for (const Piece& piece : pieces) {
    SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, readers[piece.file].ReadBytes(piece.place));
    SEXTANT_RETURN_IF_ERROR(writer.Append(bytes));
  }
  return writer.Flush();
}

}  // namespace

Expected<void> MergeRowFiles(const std::vector<std::filesystem::path>& shards,
                             const std::filesystem::path& merged) {
  if (shards.empty()) return MakeError(ErrorCode::kMissingData, "no row files to merge");
  for (const std::filesystem::path& shard : shards) {
    std::error_code ignored;
    if (!std::filesystem::equivalent(shard, merged, ignored)) continue;
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("'{}' is itself one of the files to merge; name another folder",
                                 merged.string()));
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<RowFileReader> readers, OpenAll(shards));
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<Piece> pieces, SortPieces(readers));
  return WritePieces(readers, pieces, merged);
}

Expected<void> OrderRowFile(const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<RowFileReader> readers, OpenAll({path}));
  std::vector<Piece> pieces;
  for (const RowBlockPlace& place : readers.front().blocks()) pieces.push_back({0, place});
  std::filesystem::path ordered = path;
  ordered += ".part";
  SEXTANT_RETURN_IF_ERROR(WritePieces(readers, pieces, ordered));
  std::error_code error;
  std::filesystem::rename(ordered, path, error);
  if (!error) return {};
  return MakeError(ErrorCode::kIo,
                   fmt::format("cannot write '{}': {}", path.string(), error.message()));
}

}  // namespace sextant
