/* Of LASzip's interface just what sparsha's reader calls, with the types and names that LASzip 3 has, for the library
   beside it that stands for LASzip in tests. */
#ifndef SPARSHA_TESTS_LASZIP_API_H
#define SPARSHA_TESTS_LASZIP_API_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef int laszip_BOOL;
typedef char laszip_CHAR;
typedef double laszip_F64;
typedef void* laszip_POINTER;
typedef uint8_t laszip_U8;
typedef uint16_t laszip_U16;
typedef int8_t laszip_I8;
typedef int16_t laszip_I16;
typedef int32_t laszip_I32;

typedef struct laszip_point { /* NOLINT(readability-identifier-naming): the name that LASzip has */
  laszip_I32 X;
  laszip_I32 Y;
  laszip_I32 Z;
  laszip_U16 intensity;
  laszip_U8 return_number : 3;
  laszip_U8 number_of_returns : 3;
  laszip_U8 scan_direction_flag : 1;
  laszip_U8 edge_of_flight_line : 1;
  laszip_U8 classification : 5;
  laszip_U8 synthetic_flag : 1;
  laszip_U8 keypoint_flag : 1;
  laszip_U8 withheld_flag : 1;
  laszip_I8 scan_angle_rank;
  laszip_U8 user_data;
  laszip_U16 point_source_ID;
  laszip_I16 extended_scan_angle;
  laszip_U8 extended_point_type : 2;
  laszip_U8 extended_scanner_channel : 2;
  laszip_U8 extended_classification_flags : 4;
  laszip_U8 extended_classification;
  laszip_U8 extended_return_number : 4;
  laszip_U8 extended_number_of_returns : 4;
  laszip_U8 dummy[7];
  laszip_F64 gps_time;
  laszip_U16 rgb[4];
  laszip_U8 wave_packet[29];
  laszip_I32 num_extra_bytes;
  laszip_U8* extra_bytes;
} laszip_point_struct;

/* All give 0 when they did what they should. */
laszip_I32 laszip_create(laszip_POINTER* pointer);
laszip_I32 laszip_destroy(laszip_POINTER pointer);
laszip_I32 laszip_get_error(laszip_POINTER pointer, laszip_CHAR** error);
laszip_I32 laszip_open_reader(laszip_POINTER pointer, const laszip_CHAR* file_name, laszip_BOOL* is_compressed);
laszip_I32 laszip_get_point_pointer(laszip_POINTER pointer, laszip_point_struct** point_pointer);
laszip_I32 laszip_read_point(laszip_POINTER pointer);
laszip_I32 laszip_close_reader(laszip_POINTER pointer);

#ifdef __cplusplus
}
#endif

#endif
