module grading
  !! Divisions of a parameter interval into elements: uniform, graded in geometric progression
  !! from one end to the other, or symmetrically from both ends to the middle.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: uniform_breaks, graded_breaks, symmetric_breaks, fitted_breaks

contains

  pure function uniform_breaks(from, to, n) result(x)
    real(wp), intent(in) :: from, to   !! interval
    integer, intent(in) :: n           !! number of elements, >= 1
    real(wp) :: x(n+1)                 !! their ends

    integer :: i

    x = [(from + (to - from) * i / n, i = 0, n)]
    x(n+1) = to
  end function uniform_breaks

  pure function graded_breaks(from, to, n, ratio) result(x)
    real(wp), intent(in) :: from, to   !! interval
    integer, intent(in) :: n           !! number of elements, >= 1
    real(wp), intent(in) :: ratio      !! length of the last element over that of the first, > 0
    real(wp) :: x(n+1)                 !! ends of the elements

    integer :: i

    x = stacked(from, to, [(ratio**(real(i, wp) / max(n - 1, 1)), i = 0, n - 1)])
  end function graded_breaks

  pure function symmetric_breaks(from, to, n, ratio) result(x)
    real(wp), intent(in) :: from, to   !! interval
    integer, intent(in) :: n           !! number of elements, >= 1
    real(wp), intent(in) :: ratio      !! length of a middle element over that of an end one, > 0
    real(wp) :: x(n+1)                 !! ends of the elements

    integer :: i, half

    half = (n + 1) / 2
    x = stacked(from, to, [(ratio**(real(min(i, n - 1 - i), wp) / max(half - 1, 1)), i = 0, n - 1)])
  end function symmetric_breaks

  pure function stacked(from, to, length) result(x)
    real(wp), intent(in) :: from, to     !! interval
    real(wp), intent(in) :: length(:)    !! lengths of the elements up to a common factor
    real(wp) :: x(size(length)+1)        !! their ends

    real(wp) :: total
    integer :: i

    total = sum(length)
    x(1) = from
    do i = 1, size(length)
      x(i+1) = from + (to - from) * (sum(length(1:i)) / total)
    end do
    x(size(x)) = to
  end function stacked

  pure function fitted_breaks(existing, ideal) result(x)
    !! The ideal division moved so that every existing break is kept: the nearest ideal breaks
    !! come to lie on the existing ones, those between follow linearly. With fewer ideal elements
    !! than existing ones the latter stay.
    real(wp), intent(in) :: existing(:)   !! breaks to keep, increasing
    real(wp), intent(in) :: ideal(:)      !! wanted breaks over the same interval, increasing
    real(wp), allocatable :: x(:)         !! as many as the larger of both

    integer :: at(size(existing)), i, j, m, n
    real(wp) :: part

    m = size(existing)
    n = size(ideal)
    if (n <= m) then
      x = existing
      return
    end if

    at(1) = 1
    at(m) = n
    do j = 2, m - 1
      ! enough ideal breaks must remain for the existing ones that follow
      at(j) = minloc(abs(ideal - existing(j)), 1)
      at(j) = min(max(at(j), at(j-1) + 1), n - (m - j))
    end do

    allocate (x(n))
    do j = 1, m - 1
      do i = at(j), at(j+1)
        part = (ideal(i) - ideal(at(j))) / (ideal(at(j+1)) - ideal(at(j)))
        x(i) = existing(j) + (existing(j+1) - existing(j)) * part
      end do
      x(at(j+1)) = existing(j+1)
    end do
    x(1) = existing(1)
  end function fitted_breaks
end module grading
