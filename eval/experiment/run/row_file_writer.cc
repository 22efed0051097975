// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "base/text/path_text.h"
#include "eval/experiment/run/row_checksum.h"
#include "eval/experiment/run/row_file.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

// Whether the file contains only the beginning of a header, from a run that was killed before its
// first block.
Expected<bool> IsTornHeader(const AppendedFile& file, const std::string& header) {
  if (file.size() >= header.size()) return false;
  SEXTANT_ASSIGN_OR_RETURN(const std::string begun, file.ReadBeginning(file.size()));
  return header.starts_with(begun);
}

// Whether its rows may be discarded: it is a row file, of whatever experiment.
Expected<void> RequireRowFile(const AppendedFile& file, const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string begun, file.ReadBeginning(kRowFileMark.size()));
  if (kRowFileMark.starts_with(begun)) return {};
  return MakeError(ErrorCode::kParse,
                   fmt::format("'{}' is not a row file of an experiment, and is not replaced; "
                               "remove it, or choose another folder with --out",
                               PathText(path)));
}

}  // namespace

Expected<RowFileWriter> RowFileWriter::Open(const std::filesystem::path& path,
                                            const std::string& configuration, bool fresh) {
  SEXTANT_ASSIGN_OR_RETURN(AppendedFile file, AppendedFile::Open(path));
  RowFileWriter writer(std::move(file));
  const std::string header = RowFileHeader(configuration);
  SEXTANT_ASSIGN_OR_RETURN(const bool is_torn, IsTornHeader(writer.file_, header));
  if (!fresh && !is_torn) {
    SEXTANT_RETURN_IF_ERROR(writer.Keep(path, configuration));
    return writer;
  }
  SEXTANT_RETURN_IF_ERROR(RequireRowFile(writer.file_, path));
  SEXTANT_RETURN_IF_ERROR(writer.file_.Truncate(0));
  SEXTANT_RETURN_IF_ERROR(writer.file_.Append(header));
  return writer;
}

Expected<void> RowFileWriter::Keep(const std::filesystem::path& path,
                                   const std::string& configuration) {
  SEXTANT_ASSIGN_OR_RETURN(const RowFileReader reader, RowFileReader::Open(path));
  if (reader.configuration() != configuration) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("'{}' holds the rows of another configuration of the experiment; "
                                 "start over with --fresh, or choose another folder with --out",
                                 PathText(path)));
  }
  damage_ = DescribeDamage(reader);
  is_orderly_ = reader.is_orderly();
  for (const RowBlockPlace& block : reader.blocks()) kept_.push_back(block.number);
  return file_.Truncate(reader.whole_bytes());
}

}  // namespace sextant
