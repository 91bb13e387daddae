module local_dependence
  !! Functions that are independent on the whole mesh, but not any more on the part of it that a
  !! local refinement leaves to them.
  !!
  !! Where a surface is C2, B-splines are independent on every element. Beside seams they are not:
  !! several of them together may have a smaller support than each, and this may lie in a zone where
  !! finer functions take over. The combination acts on nothing then. One control point of it can
  !! be put onto another, and the surface stays, if those of the others move along.
  use kinds, only: wp
  use sparse_row, only: row_type, clear, add_scaled_term
  implicit none (type, external)
  private
  public :: find_combination, merge_point

contains

  subroutine find_combination(rows, in_use, candidates, combination)
    !! Columns that depend on others: Gram and Schmidt, twice.
    type(row_type), intent(in) :: rows(:)                !! what control points act on
    logical, intent(in) :: in_use(:)                     !! rows that count
    integer, intent(in) :: candidates(:)                 !! control points
    type(row_type), intent(out) :: combination           !! of some of them that acts on nothing;
                                                         !! the first has the factor 1; empty: none

    real(wp), parameter :: rounding = 1e-9_wp
    real(wp), allocatable :: a(:,:), q(:,:), r(:,:)
    integer, allocatable :: basis(:)
    real(wp) :: h, length
    integer :: j, k, n, pass

    call clear(combination)
    call columns_of(rows, in_use, candidates, a)
    allocate (q, mold=a)
    allocate (r(size(candidates),size(candidates)), source=0.0_wp)
    allocate (basis(size(candidates)))
    n = 0
    do k = 1, size(candidates)
      length = norm2(a(:,k))
      if (.not. length > 0) cycle
      q(:,n+1) = a(:,k)
      r(:,n+1) = 0
      do pass = 1, 2
        do j = 1, n
          h = dot_product(q(:,j), q(:,n+1))
          q(:,n+1) = q(:,n+1) - h*q(:,j)
          r(j,n+1) = r(j,n+1) + h
        end do
      end do
      r(n+1,n+1) = norm2(q(:,n+1))
      if (.not. r(n+1,n+1) > rounding*length) exit
      q(:,n+1) = q(:,n+1)/r(n+1,n+1)
      n = n + 1
      basis(n) = k
    end do
    if (k > size(candidates)) return
    call add_scaled_term(combination, 1.0_wp, candidates(k))
    do j = n, 1, -1
      h = r(j,n+1)/r(j,j)
      r(1:j-1,n+1) = r(1:j-1,n+1) - h*r(1:j-1,j)
      if (abs(h) > rounding) call add_scaled_term(combination, -h, candidates(basis(j)))
    end do
  end subroutine find_combination

  subroutine columns_of(rows, in_use, candidates, a)
    type(row_type), intent(in) :: rows(:)
    logical, intent(in) :: in_use(:)
    integer, intent(in) :: candidates(:)
    real(wp), allocatable, intent(out) :: a(:,:)         !! of the rows that candidates act on

    integer, allocatable :: column(:)
    integer :: i, j, last, n, pass

    last = maxval([1, candidates])
    do i = 1, size(rows)
      last = max(last, maxval(rows(i)%id(1:rows(i)%n)))
    end do
    allocate (column(last), source=0)
    column(candidates) = [(j, j = 1, size(candidates))]
    do pass = 1, 2
      n = 0
      do i = 1, size(rows)
        if (.not. in_use(i)) cycle
        if (.not. any(column(rows(i)%id(1:rows(i)%n)) > 0)) cycle
        n = n + 1
        if (pass == 1) cycle
        do j = 1, rows(i)%n
          if (column(rows(i)%id(j)) > 0) a(n,column(rows(i)%id(j))) = rows(i)%c(j)
        end do
      end do
      if (pass == 1) allocate (a(n,size(candidates)), source=0.0_wp)
    end do
  end subroutine columns_of

  subroutine merge_point(combination, candidates, cp, gone, kept)
    !! Moves the control points along the combination until its first lies on another one.
    type(row_type), intent(in) :: combination
    integer, intent(in) :: candidates(:)                 !! control points to choose from
    real(wp), intent(inout) :: cp(:,:)                   !! (3,:)
    integer, intent(out) :: gone, kept                   !! the first, and the one in its place

    real(wp), parameter :: clearly = 0.1_wp
    real(wp) :: change, distance, step(3)
    integer :: i, partner

    associate (v => combination%c(1:combination%n), id => combination%id(1:combination%n))
      gone = id(1)
      partner = maxloc(abs(v - 1), 1)
      kept = id(partner)
      change = 1 - v(partner)
      if (abs(change) < clearly) then
        ! all move alike: the nearest of the others
        distance = huge(distance)
        do i = 1, size(candidates)
          if (any(id == candidates(i))) cycle
          if (norm2(cp(:,candidates(i)) - cp(:,gone)) > distance) cycle
          distance = norm2(cp(:,candidates(i)) - cp(:,gone))
          kept = candidates(i)
          change = 1
        end do
      end if
      step = (cp(:,kept) - cp(:,gone))/change
      do i = 1, size(v)
        cp(:,id(i)) = cp(:,id(i)) + v(i)*step
      end do
    end associate
  end subroutine merge_point
end module local_dependence
