# FILE is what PROGRAM manual --format FORMAT prints.
execute_process(COMMAND ${PROGRAM} manual --format ${FORMAT} OUTPUT_VARIABLE printed COMMAND_ERROR_IS_FATAL ANY)
file(READ ${FILE} kept)
if(NOT printed STREQUAL kept)
  get_filename_component(name ${PROGRAM} NAME)
  message(FATAL_ERROR "${FILE} is not what the options say now; make it anew: ${name} manual --format ${FORMAT} > ${FILE}")
endif()
