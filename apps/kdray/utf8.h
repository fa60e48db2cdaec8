/* Text as bytes that may or may not be UTF-8. */
#ifndef KDR_APPS_KDRAY_UTF8_H
#define KDR_APPS_KDRAY_UTF8_H

/* Bytes of the UTF-8 sequence at `text` (shortest form, no surrogates, at most U+10FFFF), or 0. text ends with a 0. */
int kdr_utf8_length(const unsigned char *text);

#endif
