# Prints the value under KEYS of the JSON file FILE; fails if the file is not JSON or the keys lead nowhere.
file(READ ${FILE} text)
string(JSON value GET "${text}" ${KEYS})
execute_process(COMMAND ${CMAKE_COMMAND} -E echo "${value}")
