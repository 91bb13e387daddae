integer(8) :: nph, ner
real(8) :: erav
common /prstrs/ nph, ner, erav
