# Writes OUTPUT: a copy of SOURCE with CHANGE, a unified diff. PROGRAM: patch.
get_filename_component(folder ${OUTPUT} DIRECTORY)
file(MAKE_DIRECTORY ${folder})
execute_process(COMMAND ${PROGRAM} --fuzz=0 --reject-file=- --output=${OUTPUT} ${SOURCE} ${CHANGE}
                RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(failed)
  file(REMOVE ${OUTPUT})
  message(FATAL_ERROR "${CHANGE} does not apply to ${SOURCE} any more: write it so that it takes the same mending out of the new code.\n${said}")
endif()
