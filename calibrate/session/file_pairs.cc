// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/file_pairs.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

#include "base/text/path_text.h"
#include "base/text/printable.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

// A limit for one pattern; '/*/*/*/*' would list the whole disk.
constexpr std::size_t kMaxMatches = 100'000;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Prefixes each number with its length, without leading zeros, so that keys compare by value.
std::string NaturalKey(std::string_view text) {
  std::string key;
  for (std::size_t i = 0; i < text.size();) {
    if (!IsDigit(text[i])) {
      key += text[i++];
      continue;
    }
    while (i + 1 < text.size() && text[i] == '0' && IsDigit(text[i + 1])) ++i;
    const std::size_t first = i;
    while (i < text.size() && IsDigit(text[i])) ++i;
    key += fmt::format("{:04}:{}", i - first, text.substr(first, i - first));
  }
  return key;
}

// The distinguishing part of each name: without the beginning and the end that all share.
std::vector<std::string> DistinguishingOf(const std::vector<std::string>& names) {
  std::size_t begin = names.front().size();
  std::size_t end = names.front().size();
  for (const std::string& name : names) {
    const auto ahead = std::mismatch(name.begin(), name.end(), names[0].begin(), names[0].end());
    const auto behind =
        std::mismatch(name.rbegin(), name.rend(), names[0].rbegin(), names[0].rend());
    begin = std::min(begin, static_cast<std::size_t>(ahead.first - name.begin()));
    end = std::min(end, static_cast<std::size_t>(behind.first - name.rbegin()));
  }
  // A number is not split: the 1 that 10 and 11 share is part of the number.
  while (begin > 0 && IsDigit(names[0][begin - 1])) --begin;
  while (end > 0 && IsDigit(names[0][names[0].size() - end])) --end;
  std::vector<std::string> parts;
  for (const std::string& name : names) {
    const std::size_t length = name.size() - std::min(name.size(), begin + end);
    parts.push_back(name.substr(begin, length));
  }
  return parts;
}

// The names of the files without their extensions, and where these are not enough, each folder's
// name from the file's upwards as well.
std::vector<std::string> DistinguishingParts(std::vector<fs::path> files) {
  std::vector<std::string> parts;
  constexpr int kMaxFolders = 8;
  for (int level = 0; level <= kMaxFolders; ++level) {
    std::vector<std::string> names;
    for (fs::path& file : files) {
      names.push_back(PrintableLine(file.stem().string()));
      file = file.parent_path();
    }
    const std::vector<std::string> more = DistinguishingOf(names);
    if (parts.empty()) parts.resize(more.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const bool both = !more[i].empty() && !parts[i].empty();
      parts[i] = more[i] + (both ? "/" : "") + parts[i];
    }
    const std::set<std::string> distinct(parts.begin(), parts.end());
    const bool has_folders = std::ranges::all_of(files, &fs::path::has_filename);
    if (distinct.size() == parts.size() || !has_folders) break;
  }
  return parts;
}

// The files, or the folders, in one folder that match the last part of a pattern.
Expected<void> AppendMatches(const fs::path& folder, const std::string& name, bool named,
                             std::vector<fs::path>& files) {
  std::error_code error;
  fs::directory_iterator it(folder, error);
  for (const fs::directory_iterator end; !error && it != end; it.increment(error)) {
    if (MatchesPattern(it->path().filename().string(), name)) {
      files.push_back(named ? it->path() : it->path().filename());
    }
    if (files.size() > kMaxMatches) {
      return MakeError(ErrorCode::kInvalidOption,
                       fmt::format("more than {} files match '{}'; expected a pattern that means "
                                   "the files of one session",
                                   kMaxMatches, PathText(folder / name)));
    }
  }
  if (!error) return {};
  return MakeError(ErrorCode::kIo, fmt::format("cannot read the folder '{}': {}", PathText(folder),
                                               error.message()));
}

// The folders that a pattern with stars in its folders means.
Expected<std::vector<fs::path>> FoldersOf(const fs::path& pattern) {
  if (!pattern.has_parent_path()) return std::vector<fs::path>{"."};
  const fs::path parent = pattern.parent_path();
  if (parent.string().find('*') == std::string::npos) return std::vector<fs::path>{parent};
  SEXTANT_ASSIGN_OR_RETURN(std::vector<fs::path> folders, ExpandPattern(parent));
  std::erase_if(folders, [](const fs::path& path) {
    std::error_code ignored;
    return !fs::is_directory(path, ignored);
  });
  return folders;
}

}  // namespace

bool MatchesPattern(std::string_view name, std::string_view pattern) {
  // When a part after a star does not fit, only the last star needs to take more: an earlier one
  // would leave less to match.
  constexpr std::size_t kNoStar = std::string_view::npos;
  std::size_t at = 0;
  std::size_t in_pattern = 0;
  std::size_t last_star = kNoStar;
  std::size_t taken_until = 0;  // The last star has taken the name up to here.
  while (at < name.size()) {
    if (in_pattern < pattern.size() && pattern[in_pattern] == '*') {
      last_star = in_pattern++;
      taken_until = at;
    } else if (in_pattern < pattern.size() && pattern[in_pattern] == name[at]) {
      ++in_pattern;
      ++at;
    } else if (last_star != kNoStar) {
      in_pattern = last_star + 1;
      at = ++taken_until;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', in_pattern) == std::string_view::npos;
}

Expected<std::vector<fs::path>> ExpandPattern(const fs::path& pattern) {
  const std::string name = pattern.filename().string();
  std::error_code error;
  if (pattern.string().find('*') == std::string::npos || fs::exists(pattern, error)) {
    return std::vector<fs::path>{pattern};
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<fs::path> folders, FoldersOf(pattern));
  std::vector<fs::path> files;
  for (const fs::path& folder : folders) {
    if (name.find('*') != std::string::npos) {
      SEXTANT_RETURN_IF_ERROR(AppendMatches(folder, name, pattern.has_parent_path(), files));
    } else if (fs::exists(folder / name, error)) {
      files.push_back(folder / name);
    }
  }
  if (files.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("no file is named '{}'", PathText(pattern)));
  }
  std::vector<std::pair<std::string, fs::path>> by_key;
  for (fs::path& file : files) by_key.emplace_back(NaturalKey(file.string()), std::move(file));
  std::ranges::sort(by_key);
  std::ranges::transform(by_key, files.begin(),
                         [](auto& keyed) { return std::move(keyed.second); });
  return files;
}

FilePairs PairFiles(const std::vector<fs::path>& images, const std::vector<fs::path>& clouds) {
  FilePairs result;
  if (images.size() == 1 && clouds.size() == 1) {
    result.pairs.push_back({PrintableLine(images[0].stem().string()), images[0], clouds[0]});
    return result;
  }
  std::map<std::string, FilePair> by_key;
  if (!images.empty()) {
    const std::vector<std::string> parts = DistinguishingParts(images);
    for (std::size_t i = 0; i < images.size(); ++i) {
      FilePair& pair = by_key[NaturalKey(parts[i])];
      if (!pair.image.empty()) result.without_partner.push_back(pair.image);
      pair.name = parts[i];
      pair.image = images[i];
    }
  }
  if (!clouds.empty()) {
    const std::vector<std::string> parts = DistinguishingParts(clouds);
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      FilePair& pair = by_key[NaturalKey(parts[i])];
      if (!pair.cloud.empty()) result.without_partner.push_back(pair.cloud);
      pair.cloud = clouds[i];
    }
  }
  for (const auto& [key, pair] : by_key) {
    if (pair.image.empty() || pair.cloud.empty()) {
      result.without_partner.push_back(pair.image.empty() ? pair.cloud : pair.image);
    } else {
      result.pairs.push_back(pair);
    }
  }
  return result;
}

std::vector<FileMoment> GroupFiles(const std::vector<std::vector<fs::path>>& lists) {
  const bool single =
      std::ranges::all_of(lists, [](const std::vector<fs::path>& list) { return list.size() < 2; });
  std::map<std::string, FileMoment> by_key;
  for (std::size_t k = 0; k < lists.size(); ++k) {
    if (lists[k].empty()) continue;
    const std::vector<std::string> parts =
        single ? std::vector<std::string>{""} : DistinguishingParts(lists[k]);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      FileMoment& moment = by_key[NaturalKey(parts[i])];
      if (moment.files.empty()) {
        moment.name = single ? PrintableLine(lists[k][i].stem().string()) : parts[i];
      }
      moment.files.resize(lists.size());
      moment.files[k] = lists[k][i];
    }
  }
  std::vector<FileMoment> moments;
  for (auto& [key, moment] : by_key) moments.push_back(std::move(moment));
  return moments;
}

}  // namespace sextant
