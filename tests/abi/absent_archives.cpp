// SPDX-License-Identifier: Apache-2.0
// The functions of libzip, so that the kept host links without it. The host never calls them.
#include <cstdlib>

#define ABSENT(function) \
  extern "C" void function() { std::abort(); }

ABSENT(zip_close)
ABSENT(zip_discard)
ABSENT(zip_error_code_system)
ABSENT(zip_fclose)
ABSENT(zip_file_add)
ABSENT(zip_file_set_dostime)
ABSENT(zip_fopen_index)
ABSENT(zip_fread)
ABSENT(zip_get_error)
ABSENT(zip_get_name)
ABSENT(zip_get_num_entries)
ABSENT(zip_open)
ABSENT(zip_set_file_compression)
ABSENT(zip_source_buffer)
ABSENT(zip_source_free)
ABSENT(zip_strerror)
