# Read by CTest after the tests' names are known.
set_tests_properties(
  TouchToSoundLive.ATapIsHeardByAnotherClientWithin10MillisecondsNeverBeforeItOnceEach
  TouchToSoundLive.WordsDelayNeitherAStrikeNorTheServo
  TouchToSoundOnADesktop.ATapIsHeardWithin24MillisecondsNeverBeforeItOnceEach
  PROPERTIES RUN_SERIAL ON)
