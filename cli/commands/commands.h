// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

// Every command of `sextant`; each is defined in the file of its name.
namespace sextant::cli {

Command AdviseCommand();
Command AverageCommand();
Command BagCommand();
Command BoardsCommand();
Command CalibrateCommand();
Command CaptureCommand();
Command CheckCommand();
Command CompareCommand();
Command CompletionCommand();
Command ConvertCommand();
Command DetectCommand();
Command ExportCommand();
Command FuseCommand();
Command ListCommand();
Command ManualCommand();
Command MarkCommand();  ///< In cli/mark.
Command MergeCommand();
Command PrintBoardCommand();
Command ProjectCommand();
Command RefineSceneCommand();
Command ReportCommand();
Command ReproduceCommand();
Command RigCommand();
Command RunCommand();
Command SimulateCommand();
Command SolveCommand();

/// Subcommands of `list`.
Command ListDetectorsCommand();
Command ListExtractorsCommand();
Command ListKindsCommand();
Command ListLidarsCommand();
Command ListSolversCommand();

/// Subcommand of `simulate`.
Command SimulatePairsCommand();

}  // namespace sextant::cli
