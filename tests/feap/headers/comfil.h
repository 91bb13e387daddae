character(256) :: record
common /comrec/ record
