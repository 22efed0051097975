// SPDX-License-Identifier: Apache-2.0
// Recordings of ROS 2 in SQLite: the tables topics and messages (rosbag2_storage_sqlite3).
#include <fmt/core.h>
#include <sqlite3.h>

#include <algorithm>
#include <unordered_map>

#include "base/text/path_text.h"
#include "io/bag/decompress.h"
#include "io/bag/open_bytes.h"
#include "io/bag/topic_table.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

using std::string_view_literals::operator""sv;

constexpr const char* kMessagesInOrder =
    "SELECT id, topic_id, timestamp, data FROM messages ORDER BY id";

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

// The path as a URI, with the special characters of URIs escaped.
std::string UriOf(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : path.string()) {
    uri += c == '?' || c == '#' || c == '%' ? fmt::format("%{:02x}", static_cast<unsigned char>(c))
                                            : std::string(1, c);
  }
  return uri;
}

std::string Text(sqlite3_stmt* row, int column) {
  const void* const text = sqlite3_column_blob(row, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(row, column));
  return text == nullptr ? std::string() : std::string(static_cast<const char*>(text), size);
}

class Rosbag2Sqlite final : public Bag {
 public:
  explicit Rosbag2Sqlite(const std::filesystem::path& path) : path_(path), file_(PathText(path)) {}

  std::string_view format() const override { return "ROS 2 bag (SQLite)"; }

  Expected<void> Open();
  Expected<void> Read(const std::vector<std::size_t>& topic_indices,
                      const Visitor& visit) const override;

 private:
  void Limit();
  Expected<void> ReadTopics();
  Expected<void> CountRows();
  Expected<void> CountRowsBeforeCut();
  // Calls `take` for each row of the result. In a database that is cut short, rows end before the
  // first page that is missing.
  Expected<void> Query(const char* sql,
                       const std::function<Expected<void>(sqlite3_stmt*)>& take) const;
  tl::unexpected<Error> DatabaseError() const;
  Expected<void> VisitRow(sqlite3_stmt* row, const Visitor& visit) const;

  std::filesystem::path path_;
  std::string file_;
  Database database_{nullptr, sqlite3_close};
  TopicTable table_;
  std::unordered_map<std::int64_t, std::size_t> topic_of_id_;
};

tl::unexpected<Error> Rosbag2Sqlite::DatabaseError() const {
  return MakeError(ErrorCode::kParse,
                   fmt::format("{}: expected a recording of ROS 2 (SQLite with the tables topics "
                               "and messages): {}",
                               file_, Printable(sqlite3_errmsg(database_.get()), 100)));
}

Expected<void> Rosbag2Sqlite::Open() {
  // "immutable" allows reading from a folder without write permission. A write-ahead log next to
  // the file means that the file was not closed; then the log must be read too.
  std::error_code ignored;
  const bool has_log = std::filesystem::file_size(path_.string() + "-wal", ignored) > 0 && !ignored;
  const std::string uri = UriOf(path_) + (has_log ? "" : "?immutable=1");
  sqlite3* raw = nullptr;
  const int result =
      sqlite3_open_v2(uri.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  database_.reset(raw);
  if (result != SQLITE_OK) return DatabaseError();
  Limit();
  Expected<void> ok = ReadTopics();
  if (ok) ok = CountRows();
  if (ok || sqlite3_errcode(raw) != SQLITE_CORRUPT) return ok;
  // A page is missing. SQLite refuses a file with fewer pages than its header states, unless its
  // schema may be repaired; nothing is written, as the file is open for reading only.
  const std::uintmax_t size = std::filesystem::file_size(path_, ignored);
  cut_ = {.byte = ignored ? 0 : size, .reason = "a page of the database is missing or damaged"};
  sqlite3_exec(raw, "PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);
  topics_.clear();
  table_ = {};
  SEXTANT_RETURN_IF_ERROR(ReadTopics());
  SEXTANT_RETURN_IF_ERROR(CountRowsBeforeCut());
  return RequireMessages(file_, *cut_, topics_);
}

// The database may be hostile: only tables are read, and no value is larger than the file.
void Rosbag2Sqlite::Limit() {
  sqlite3* const database = database_.get();
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  std::error_code failed;
  const std::uintmax_t size = std::filesystem::file_size(path_, failed);
  sqlite3_limit(
      database, SQLITE_LIMIT_LENGTH,
      static_cast<int>(std::clamp<std::uintmax_t>(failed ? 0 : size, 1 << 16, 1'000'000'000)));
}

Expected<void> Rosbag2Sqlite::ReadTopics() {
  return Query("SELECT id, name, type, serialization_format FROM topics ORDER BY id",
               [this](sqlite3_stmt* row) -> Expected<void> {
                 const MessageEncoding encoding =
                     Text(row, 3) == "cdr" ? MessageEncoding::kCdr : MessageEncoding::kUnknown;
                 topic_of_id_[sqlite3_column_int64(row, 0)] =
                     table_.IndexOf(Text(row, 1), Ros1TypeName(Text(row, 2)), encoding, topics_);
                 return {};
               });
}

Expected<void> Rosbag2Sqlite::CountRows() {
  return Query(
      "SELECT topic_id, COUNT(*), MIN(timestamp), MAX(timestamp) FROM messages GROUP BY topic_id",
      [this](sqlite3_stmt* row) -> Expected<void> {
        const auto known = topic_of_id_.find(sqlite3_column_int64(row, 0));
        if (known == topic_of_id_.end()) return {};
        AddMessages(topics_[known->second], static_cast<std::size_t>(sqlite3_column_int64(row, 1)),
                    std::max<std::int64_t>(sqlite3_column_int64(row, 2), 0),
                    std::max<std::int64_t>(sqlite3_column_int64(row, 3), 0));
        return {};
      });
}

// Only of rows whose data can be read.
Expected<void> Rosbag2Sqlite::CountRowsBeforeCut() {
  return Query(kMessagesInOrder, [this](sqlite3_stmt* row) -> Expected<void> {
    const auto known = topic_of_id_.find(sqlite3_column_int64(row, 1));
    if (known == topic_of_id_.end()) return {};
    CountMessage(topics_[known->second], std::max<std::int64_t>(sqlite3_column_int64(row, 2), 0));
    return {};
  });
}

Expected<void> Rosbag2Sqlite::Query(
    const char* sql, const std::function<Expected<void>(sqlite3_stmt*)>& take) const {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql, -1, &raw, nullptr) != SQLITE_OK) {
    return DatabaseError();
  }
  const Statement statement(raw, sqlite3_finalize);
  while (true) {
    const int result = sqlite3_step(raw);
    if (result == SQLITE_DONE || (cut_ && result == SQLITE_CORRUPT)) return {};
    if (result != SQLITE_ROW) return DatabaseError();
    SEXTANT_RETURN_IF_ERROR(take(raw));
  }
}

Expected<void> Rosbag2Sqlite::Read(const std::vector<std::size_t>& topic_indices,
                                   const Visitor& visit) const {
  const std::vector<bool> wanted = WantedTopics(topics_, topic_indices);
  return Query(kMessagesInOrder, [&](sqlite3_stmt* row) -> Expected<void> {
    const auto known = topic_of_id_.find(sqlite3_column_int64(row, 1));
    if (known == topic_of_id_.end()) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: message {}: its topic {} is missing", file_,
                                   sqlite3_column_int64(row, 0), sqlite3_column_int64(row, 1)));
    }
    return wanted[known->second] ? VisitRow(row, visit) : Expected<void>();
  });
}

Expected<void> Rosbag2Sqlite::VisitRow(sqlite3_stmt* row, const Visitor& visit) const {
  const std::size_t topic = topic_of_id_.at(sqlite3_column_int64(row, 1));
  std::string data = Text(row, 3);
  if (data.starts_with("\x28\xb5\x2f\xfd"sv)) {
    Expected<std::string> unpacked = DecompressZstdFrame(data);
    if (!unpacked) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: message {}: {}", file_, sqlite3_column_int64(row, 0),
                                   unpacked.error().message));
    }
    data = std::move(*unpacked);
  }
  const std::int64_t time = std::max<std::int64_t>(sqlite3_column_int64(row, 2), 0);
  return visit({&topics_[topic], topic, time, data});
}

}  // namespace

Expected<std::unique_ptr<Bag>> OpenRosbag2Sqlite(const std::filesystem::path& path) {
  auto bag = std::make_unique<Rosbag2Sqlite>(path);
  SEXTANT_RETURN_IF_ERROR(bag->Open());
  return std::unique_ptr<Bag>(std::move(bag));
}

}  // namespace sextant
