module nurbs_refinement
  !! Degree elevation, knot insertion and subdivision of NURBS patches. The geometry stays: a
  !! linear operator of one direction acts on the homogeneous control points (w x, w y, w z, w).
  use kinds, only: wp
  use status_codes, only: ok, bad_knots
  use knot_vectors, only: knot_vector, insertion_operator, elevation_operator
  use nurbs_patch, only: nurbs_patch_type
  implicit none (type, external)
  private
  public :: elevate_degree, insert_knots, subdivide

  !> breaks closer to a knot than this part of the domain count as that knot
  real(wp), parameter :: same_knot = 1.0e-10_wp

contains

  pure subroutine elevate_degree(patch, dir, times)
    type(nurbs_patch_type), intent(inout) :: patch
    integer, intent(in) :: dir     !! direction, 1..dp
    integer, intent(in) :: times   !! by how much, >= 0

    type(knot_vector) :: elevated
    real(wp), allocatable :: a(:,:)
    integer :: k

    do k = 1, times
      call elevation_operator(patch%knots(dir), elevated, a)
      call apply_along(patch, dir, a)
      patch%knots(dir) = elevated
    end do
  end subroutine elevate_degree

  pure subroutine insert_knots(patch, dir, new, status)
    type(nurbs_patch_type), intent(inout) :: patch   !! unchanged unless ok
    integer, intent(in) :: dir        !! direction, 1..dp
    real(wp), intent(in) :: new(:)    !! knots strictly inside the domain, any order, also repeated
    integer, intent(out) :: status    !! ok or bad_knots

    type(knot_vector) :: refined
    real(wp), allocatable :: a(:,:)

    call insertion_operator(patch%knots(dir), new, refined, a, status)
    if (status /= ok) return
    call apply_along(patch, dir, a)
    patch%knots(dir) = refined
  end subroutine insert_knots

  pure subroutine subdivide(patch, dir, breaks, status)
    !! Inserts once each break that is not a knot: the functions are C^(p-1) there.
    type(nurbs_patch_type), intent(inout) :: patch   !! unchanged unless ok
    integer, intent(in) :: dir         !! direction, 1..dp
    real(wp), intent(in) :: breaks(:)  !! in the domain, increasing, its ends may be among them
    integer, intent(out) :: status     !! ok or bad_knots

    real(wp), allocatable :: present(:)
    logical :: is_new(size(breaks))
    real(wp) :: near
    integer :: i

    allocate (present, source=patch%knots(dir)%breaks())
    near = same_knot * (present(size(present)) - present(1))
    status = bad_knots
    do i = 2, size(breaks)
      if (.not. breaks(i) > breaks(i-1) + near) return
    end do
    do i = 1, size(breaks)
      is_new(i) = all(abs(present - breaks(i)) > near)
    end do
    call insert_knots(patch, dir, pack(breaks, is_new), status)
  end subroutine subdivide

  pure subroutine apply_along(patch, dir, a)
    !! Homogeneous control points times an operator of one direction.
    type(nurbs_patch_type), intent(inout) :: patch
    integer, intent(in) :: dir        !! direction, 1..dp
    real(wp), intent(in) :: a(:,:)    !! operator (new functions, functions)

    real(wp), allocatable :: cp(:,:)
    real(wp) :: w
    integer :: n(3), before, behind, i, j, k, m, old

    n = patch%functions()
    before = product(n(1:dir-1))
    behind = product(n(dir+1:3))
    allocate (cp(4,before*size(a, 1)*behind), source=0.0_wp)
    do k = 0, behind - 1
      do j = 1, size(a, 2)
        do m = 1, size(a, 1)
          if (abs(a(m,j)) <= 0.0_wp) cycle
          do i = 1, before
            old = i + before * (j - 1 + size(a, 2) * k)
            w = a(m,j) * patch%cp(4,old)
            associate (new => cp(:,i+before*(m-1+size(a, 1)*k)))
              new(1:3) = new(1:3) + w * patch%cp(1:3,old)
              new(4) = new(4) + w
            end associate
          end do
        end do
      end do
    end do
    do i = 1, size(cp, 2)
      cp(1:3,i) = cp(1:3,i) / cp(4,i)
    end do
    call move_alloc(cp, patch%cp)
  end subroutine apply_along
end module nurbs_refinement
