program link_alone
  !! Holds all of shapes and elements and nothing else; the check beside it looks at what that
  !! needs.
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use bernstein, only: bernstein_1d
  use interface_law, only: gap_law, contact_law
  implicit none (type, external)
  real(wp) :: b(0:3)
  type(gap_law) :: law
  integer :: status

  call bernstein_1d(3, 0.25_wp, b)
  if (abs(sum(b) - 1) > 1e-15_wp) error stop 'the Bernstein polynomials do not sum to one'
  call contact_law(1.0_wp, law, status)
  if (status /= ok) error stop 'a penalty of one is refused'
  print '(a)', status_text(status)
end program link_alone
