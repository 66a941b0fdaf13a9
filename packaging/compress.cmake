# Man pages and Debian's list of changes as Debian has them: gzip without name and time, so that the same text gives the same
# bytes. cmake -DFOLDER=build/manual -DCHANGES=build/packaging/changelog -P compress.cmake
file(COPY_FILE ${CHANGES} ${FOLDER}/changelog)
file(GLOB pages ${FOLDER}/man1/*.1 ${FOLDER}/man5/*.5 ${FOLDER}/changelog)
execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
