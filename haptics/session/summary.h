// What servo and recorder counted, as a run's summary has it.
#pragma once

#include "haptics/replay/recorder.h"
#include "haptics/servo/servo.h"
#include "haptics/session/session.h"

namespace sparsha::haptics {

void add_figures(SessionSummary& summary, const ServoFigures& servo);
void add_figures(SessionSummary& summary, const RunFigures& figures);

}  // namespace sparsha::haptics
