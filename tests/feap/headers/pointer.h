integer(8) :: np, up
common /pointer/ np(400), up(200)
