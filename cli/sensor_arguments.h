// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.h"

namespace CLI {
class App;
}

// The arguments of the commands that look at photos, scans and recordings.
namespace sextant::cli {

void AddDetect(CLI::App& app, DetectOptions& options);
/// Options of every command that searches scans for boards.
void AddSearch(CLI::App& command, SearchArguments& search);
void AddBoards(CLI::App& app, BoardsOptions& options);
void AddMark(CLI::App& app, MarkOptions& options);
void AddBoard(CLI::App& app, BoardOptions& options);
void AddBag(CLI::App& app, BagOptions& options);
void AddDetectors(CLI::App& app, DetectorStudyCommandOptions& options);
void AddExtractors(CLI::App& app, ExtractorStudyCommandOptions& options);

}  // namespace sextant::cli
