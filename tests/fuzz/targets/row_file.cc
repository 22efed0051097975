// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/run/row_file.h"

#include "eval/experiment/run/row_checksum.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {
namespace {

// A whole row file of the bytes: a configuration, a zero byte, the body of a block. Random bytes
// would never have the right checksums.
std::string Sealed(std::string_view bytes) {
  const std::size_t end = std::min(bytes.find('\0'), bytes.size());
  std::string block(bytes.substr(std::min(end + 1, bytes.size())));
  block.resize((block.size() + 7) / 8 * 8, '\0');
  std::string file = RowFileHeader(std::string(bytes.substr(0, end)));
  const std::uint64_t checksum = RowChecksum(block);
  file += block;
  return file.append(reinterpret_cast<const char*>(&checksum), sizeof checksum);
}

void ReadAll(const RowFileReader& reader) {
  for (const RowBlockPlace& block : reader.blocks()) {
    CheckOutcome(reader.ReadKeys(block));
    CheckOutcome(reader.ReadBytes(block));
    for (std::size_t column = 0; column < reader.columns(); ++column) {
      CheckOutcome(reader.ReadColumn(block, column));
    }
  }
}

// A run that continues in the file keeps every block that a reader of the file finds.
void Continue(const std::filesystem::path& path, const RowFileReader& before) {
  const Expected<RowFileWriter> writer =
      RowFileWriter::Open(path, before.configuration(), /*fresh=*/false);
  CheckOutcome(writer);
  if (!writer) return;
  const Expected<RowFileReader> after = RowFileReader::Open(path);
  CheckOutcome(after);
  if (!after || after->blocks().size() != before.blocks().size() ||
      writer->kept().size() != before.blocks().size()) {
    Fault("blocks are lost when a run continues");
  }
}

}  // namespace

SEXTANT_FUZZ_TARGET(row_file, bytes) {
  static InputFile file("rows.sxtrows");
  // The first byte selects the file itself or the content of one.
  const bool is_sealed = !bytes.empty() && bytes.front() == '\0';
  const std::filesystem::path& path =
      file.Write(is_sealed ? Sealed(bytes.substr(1)) : std::string(bytes));
  const Expected<RowFileReader> reader = RowFileReader::Open(path);
  CheckOutcome(reader);
  if (!reader) return;
  ReadAll(*reader);
  Continue(path, *reader);
}

}  // namespace sextant::test
