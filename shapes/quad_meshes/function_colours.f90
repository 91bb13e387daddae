module function_colours
  !! Colours of the functions of a spline on a quadrilateral mesh: those of one colour are so far apart that what is done
  !! with all of them at once can be told apart, face by face.
  use sparse_row, only: row_type, clear, add_term
  use quad_mesh, only: face_of
  use unstructured_spline, only: unstructured_spline_type
  implicit none (type, external)
  private
  public :: colour_functions

  type :: face_list
    integer, allocatable :: faces(:)
  end type face_list

contains

  subroutine colour_functions(spline, colour)
    !! Functions of one colour have no face in common, nor neighbouring faces of theirs.
    type(unstructured_spline_type), intent(in) :: spline
    integer, allocatable, intent(out) :: colour(:)

    type(face_list), allocatable :: near(:)
    logical, allocatable :: taken(:)
    integer :: a, round

    call find_near_faces(spline, near)
    allocate (taken(spline%mesh%nf))
    allocate (colour(spline%slots%n), source=0)
    round = 0
    do while (any(colour == 0))
      round = round + 1
      taken = .false.
      do a = 1, spline%slots%n
        if (colour(a) > 0) cycle
        if (any(taken(near(a)%faces))) cycle
        colour(a) = round
        taken(near(a)%faces) = .true.
      end do
    end do
  end subroutine colour_functions

  subroutine find_near_faces(spline, near)
    !! The faces that a function lies on and the faces at the vertices of these.
    type(unstructured_spline_type), intent(in) :: spline
    type(face_list), allocatable, intent(out) :: near(:)     !! of each function (slots%n)

    integer, allocatable :: first(:), own(:), found(:)
    integer, allocatable :: face_seen(:), vertex_seen(:)     ! the last function that met it
    integer :: a, c, i, k, n, turning

    call list_faces(spline, first, own)
    associate (mesh => spline%mesh)
      allocate (near(spline%slots%n), found(mesh%nf))
      allocate (face_seen(mesh%nf), vertex_seen(mesh%nv), source=0)
      do a = 1, size(near)
        n = 0
        do i = first(a), first(a+1) - 1
          do c = 4*own(i) - 3, 4*own(i)
            associate (v => mesh%vertex(c))
              if (vertex_seen(v) == a) cycle
              vertex_seen(v) = a
              turning = mesh%corner(v)
              do k = 1, mesh%faces(v)
                associate (f => face_of(turning))
                  if (face_seen(f) /= a) then
                    n = n + 1
                    found(n) = f
                    face_seen(f) = a
                  end if
                end associate
                turning = mesh%turn(turning)
              end do
            end associate
          end do
        end do
        near(a)%faces = found(1:n)
      end do
    end associate
  end subroutine find_near_faces

  subroutine list_faces(spline, first, face)
    !! The faces that function a lies on: face(first(a)), ..., face(first(a+1)-1).
    type(unstructured_spline_type), intent(in) :: spline
    integer, allocatable, intent(out) :: first(:), face(:)

    type(row_type) :: on_face
    integer, allocatable :: next(:)
    integer :: a, f, j

    allocate (first(spline%slots%n+1), source=0)
    do f = 1, spline%mesh%nf
      call collect(f)
      do j = 1, on_face%n
        first(on_face%id(j)+1) = first(on_face%id(j)+1) + 1
      end do
    end do
    first(1) = 1
    do a = 1, spline%slots%n
      first(a+1) = first(a+1) + first(a)
    end do
    allocate (face(first(size(first))-1))
    allocate (next, source=first)
    do f = 1, spline%mesh%nf
      call collect(f)
      do j = 1, on_face%n
        face(next(on_face%id(j))) = f
        next(on_face%id(j)) = next(on_face%id(j)) + 1
      end do
    end do

  contains

    subroutine collect(f)
      !! The functions on a face, each once.
      integer, intent(in) :: f

      integer :: i, k

      call clear(on_face)
      do k = 1, (spline%degree(f)+1)**2
        do i = 1, spline%b(k,f)%n
          call add_term(on_face, spline%b(k,f)%id(i))
        end do
      end do
    end subroutine collect
  end subroutine list_faces
end module function_colours
